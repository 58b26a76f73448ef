/**
 * Predictions: a question, a guess, and the answer that the run itself gives. Nothing is scored or sent; a prediction
 * may be skipped.
 */

import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h, uniqueId } from '../ui/dom.js';
import { reasonOf } from './figure.js';
import { HEAD_PX } from './stops.js';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { Guessed, Lab, Prediction } from './types.js'
 */

/** The predictions that were made. A figure shows what would give an answer away only after its prediction. */
export class Stops {
  /** @type {Map<string, Signal<boolean>>} */
  #open;

  /** @type {Map<string, Signal<number | null>>} */
  #picks;

  constructor() {
    this.#open = new Map();
    this.#picks = new Map();
    /** @type {Map<string, Guessed>} */
    this.outcomes = new Map();
    /**
     * The present entries of a learner, by the stop.
     * @type {Map<string, { question: string, get: () => string | number | null, reveal: () => Promise<void> }>}
     */
    this.entries = new Map();
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
    if (!this.state(stop).peek()) this.pickOf(stop).value = particle;
  }
}

/**
 * Gives a question of the page's markup its controls.
 * @param {HTMLElement} host @param {Prediction} prediction @param {{ lab: Promise<Lab>, stops: Stops }} context
 */
export function mountPrediction(host, prediction, { lab, stops }) {
  const { id } = host;
  const question = host.querySelector('.predict-question')?.textContent?.trim() ?? '';
  const input = inputOf(prediction, question, stops.pickOf(id));
  stops.entries.set(id, { question, get: input.get, reveal: () => answer(input.get()) });
  const result = h('div', { class: 'predict-result', role: 'status', tabindex: '-1' });
  const reveal = button({ type: 'submit', class: 'primary' }, 'Reveal');
  const skip = button({ class: 'plain', press: () => void answer(null) }, 'Skip');
  const submit = (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const guess = input.get();
    if (guess === null) fill(result, h('p', null, `${input.missing} You can also skip the question.`));
    else void answer(guess);
  };
  const form = h(
    'form',
    { class: 'predict-form', on: { submit } },
    input.element,
    h('div', { class: 'controls' }, reveal, skip),
  );

  /** @param {string | number | null} guess */
  async function answer(guess) {
    const isFocused = form.contains(document.activeElement);
    reveal.disabled = true;
    skip.disabled = true;
    fill(result, h('p', null, 'The run is asked.'));
    try {
      const { right, words } = await prediction.answer(await lab, guess);
      const judged = guess === null ? '' : (prediction.judge ?? plainJudge)(guess, right);
      fill(result, judged ? h('p', { class: 'predict-judged' }, judged) : null, h('p', null, words));
      stops.outcomes.set(id, { stop: id, question, guess, answer: words });
      host.dataset.state = 'open';
      input.lock();
      form.querySelector('.controls')?.remove();
      // The button that was pressed is gone.
      if (isFocused) result.focus({ preventScroll: true });
      stops.state(id).value = true;
      showFigure(host);
    } catch (error) {
      fill(result, h('p', null, reasonOf(error)));
      reveal.disabled = false;
      skip.disabled = false;
    }
  }
  host.append(form, result);
}

/**
 * Brings the figure of a question into view, and as much of the answer as there is room for.
 * @param {HTMLElement} host
 */
function showFigure(host) {
  const stages = [...(host.closest('.chapter')?.querySelectorAll('.stage') ?? [])];
  const isBelow = (/** @type {Element} */ one) =>
    (host.compareDocumentPosition(one) & Node.DOCUMENT_POSITION_FOLLOWING) !== 0;
  const stage = stages.find(isBelow) ?? stages[0];
  const [seen, chart] = ['.picture, .drawing, .cost', '.chart:not([hidden])'].map((name) => stage?.querySelector(name));
  if (!seen) return;
  const [answer, figure, last] = [host.querySelector('.predict-result') ?? host, seen, chart ?? seen].map((one) =>
    one.getBoundingClientRect(),
  );
  const height = last.bottom - Math.min(answer.top, figure.top);
  const target = chart && height < innerHeight - HEAD_PX ? chart : seen;
  target.scrollIntoView({ block: 'nearest' });
}

/** @param {string | number} guess @param {string | number} right */
const plainJudge = (guess, right) => (guess === right ? 'As you said.' : 'The run says otherwise.');

/** @param {Prediction} prediction @param {string} question @param {Signal<number | null>} picked */
function inputOf(prediction, question, picked) {
  const { kind } = prediction;
  if (kind === 'pick')
    return {
      element: null,
      missing: 'Press a particle of the picture first.',
      get: () => picked.peek(),
      lock: () => {},
    };
  if (kind === 'number') {
    const id = uniqueId('guess');
    const box = h('input', {
      class: 'box',
      id,
      type: 'number',
      inputmode: 'numeric',
      min: 0,
      max: prediction.most ?? 9999,
      step: 1,
    });
    return {
      element: h('div', { class: 'predict-number' }, h('label', { for: id }, prediction.label ?? 'Your guess'), box),
      missing: 'Write a number first.',
      get: () => (box.value === '' || !box.checkValidity() ? null : Number(box.value)),
      lock: () => {
        box.disabled = true;
      },
    };
  }
  const name = uniqueId('guess');
  const radios = (prediction.choices ?? []).map(({ value }) => h('input', { type: 'radio', name, value }));
  const labels = (prediction.choices ?? []).map(({ label }, k) => h('label', { class: 'check' }, radios[k], label));
  return {
    element: h('fieldset', { class: 'predict-choices' }, h('legend', { class: 'visually-hidden' }, question), labels),
    missing: 'Choose an answer first.',
    get: () => radios.find(({ checked }) => checked)?.value ?? null,
    lock: () => {
      for (const radio of radios) radio.disabled = true;
    },
  };
}
