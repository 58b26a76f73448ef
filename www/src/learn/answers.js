/** The learner's answers, which the browser keeps. */
import { signal } from '@preact/signals-core';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { Guessed } from './types.js'
 */

/** The name of the text from which pairs are drawn, among what the browser keeps. */
const SERIES = 'series';
/** The names of what is no answer. */
const NO_ANSWERS = [SERIES, 'judge-at', 'judge-count'];

/** The predictions that were made. A figure shows what would give an answer away only after its prediction. */
export class Stops {
  /** @type {Map<string, Signal<boolean>>} */
  #open = new Map();

  /** @type {Map<string, Signal<number | null>>} */
  #picks = new Map();

  /** What the browser keeps beside the outcomes: guesses before their answers, and the slots that were decided. */
  #more;
  #keep;

  /** @type {Map<string, Guessed>} */
  outcomes;

  /**
   * The guesses that stand in the page, by the stop.
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

  /** Whether there is something to forget. */
  isBegun() {
    return this.outcomes.size > 0 || Object.keys(this.#more).some((name) => !NO_ANSWERS.includes(name));
  }

  /** What the pairs that are drawn follow from: the same as before, in this browser. */
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

  /** What is kept by a name; undefined for nothing. @param {string} name @returns {any} */
  more(name) {
    return this.#more[name];
  }

  /** @param {string} name @param {unknown} value */
  keepMore(name, value) {
    this.#more[name] = value;
    this.#write();
  }

  /** Returns the guesses, with their answers where these are out. */
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

  /** @param {string} stop */
  pickOf(stop) {
    const known = this.#picks.get(stop) ?? signal(/** @type {number | null} */ (null));
    this.#picks.set(stop, known);
    return known;
  }

  /** Whether a prediction was made. An effect that asks runs again once it is. @param {string} stop */
  isOpen(stop) {
    return this.state(stop).value;
  }

  /** The particle that was pressed, once there is one. @param {string} stop */
  picked(stop) {
    return this.pickOf(stop).value;
  }

  /** @param {string} stop @param {number} particle */
  pick(stop, particle) {
    if (this.state(stop).peek()) return;
    this.pickOf(stop).value = particle;
    this.keepMore(stop, particle);
  }
}

/** What was kept; nothing if it cannot be read. @param {string} text @returns {any} */
function read(text) {
  try {
    return JSON.parse(text) ?? {};
  } catch {
    return {};
  }
}
