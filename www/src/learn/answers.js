/** The learner's answers, which are stored in the browser. */
import { signal } from '@preact/signals-core';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { Guessed } from './types.js'
 */

/** The name under which the text is stored from which pairs are drawn. */
const SERIES = 'series';
/** Names of stored values that are not answers. */
const NO_ANSWERS = [SERIES, 'judge-at', 'judge-count'];

/** The predictions made so far. A figure that would give an answer away waits for its prediction. */
export class Stops {
  /** @type {Map<string, Signal<boolean>>} */
  #open = new Map();

  /** Other stored values: guesses before their answers, and the decided slots. */
  #more;
  #keep;

  /** @type {Map<string, Guessed>} */
  outcomes;

  /**
   * The guesses entered in the page, by stop.
   * @type {Map<string, { question: string, get: () => string | number | null }>}
   */
  entries = new Map();

  /** @param {string} [text] what was kept @param {(text: string) => void} [keep] */
  constructor(text = '', keep = () => {}) {
    const { outcomes = [], more = {} } = read(text);
    this.outcomes = new Map(outcomes.map((/** @type {Guessed} */ one) => [one.stop, one]));
    this.#more = more;
    this.#keep = keep;
    for (const stop of this.outcomes.keys()) this.open(stop);
  }

  /** Whether there are stored answers to delete. */
  isBegun() {
    return this.outcomes.size > 0 || Object.keys(this.#more).some((name) => !NO_ANSWERS.includes(name));
  }

  /** The text from which pairs are drawn; it stays the same in this browser. */
  series() {
    if (!this.#more[SERIES]) this.keepMore(SERIES, Math.random().toString(36).slice(2));
    return this.#more[SERIES];
  }

  #write() {
    this.#keep(JSON.stringify({ outcomes: [...this.outcomes.values()], more: this.#more }));
  }

  forget() {
    this.outcomes.clear();
    this.#more = {};
    this.#keep('');
  }

  /** @param {Guessed} outcome */
  record(outcome) {
    this.outcomes.set(outcome.stop, outcome);
    this.#write();
  }

  /** The stored value with a name; undefined if there is none. @param {string} name @returns {any} */
  more(name) {
    return this.#more[name];
  }

  /** @param {string} name @param {unknown} value */
  keepMore(name, value) {
    this.#more[name] = value;
    this.#write();
  }

  /** Returns the guesses, with those answers that are known. */
  predictions() {
    const open = [...this.entries].filter(([stop]) => !this.outcomes.has(stop));
    const waiting = open.map(([stop, { question, get }]) => ({ stop, question, guess: get(), answer: '' }));
    return [...this.outcomes.values(), ...waiting.filter(({ guess }) => guess !== null)];
  }

  /** @param {string} stop */
  state(stop) {
    const known = this.#open.get(stop) ?? signal(false);
    this.#open.set(stop, known);
    return known;
  }

  /** Lets figures show the answer. @param {string} stop */
  open(stop) {
    this.state(stop).value = true;
  }

  /** Whether a prediction was made. An effect that calls this runs again when it is. @param {string} stop */
  isOpen(stop) {
    return this.state(stop).value;
  }
}

/** Parses the stored text; returns nothing if it is not valid. @param {string} text @returns {any} */
function read(text) {
  try {
    return JSON.parse(text) ?? {};
  } catch {
    return {};
  }
}
