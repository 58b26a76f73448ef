/**
 * Predictions: a question, a guess, and the answer that the run itself gives. Nothing is scored or sent; a prediction
 * may be skipped.
 */

import { button } from '../ui/button.js';
import { fill, h, uniqueId } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { eyeOf } from './answers.js';
import { reasonOf, whenNear } from './figure.js';
import { HEAD_PX } from './stops.js';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { Guessed, Lab, Prediction, Stops } from './types.js'
 */

/**
 * Gives a question of the page's markup its controls. An answer that was kept stands there at once, and is asked for
 * again when the question comes near.
 * @param {HTMLElement} host @param {Prediction} prediction @param {{ lab: Promise<Lab>, stops: Stops }} context
 */
export function mountPrediction(host, prediction, { lab, stops }) {
  const { id } = host;
  const question = host.querySelector('.predict-question')?.textContent?.trim() ?? '';
  const input = inputOf(prediction, question, stops.pickOf(id));
  const eye = createEye(id, prediction, stops);
  stops.entries.set(id, {
    question,
    get: input.get,
    look: eye.look,
    reveal: () => answer(input.get()),
    /** What is right, for the one who presents. */
    async ask() {
      const { right, words } = await prediction.answer(await lab, null);
      return [nameOf(right), words].filter(Boolean).join(' ');
    },
  });
  const result = h('div', { class: 'predict-result', role: 'status', tabindex: '-1' });
  const reveal = button({ type: 'submit', class: 'primary' }, () => (eye.isOver() ? 'Reveal' : 'Show the figures'));
  const skip = button({ class: 'plain', press: () => void answer(null) }, 'Skip');
  const submit = (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const guess = (eye.isOver() ? input : eye).get();
    if (guess !== null) fill(result);
    if (guess !== null && eye.look()) return;
    if (guess === null) fill(result, h('p', null, `${input.missing} You can also skip the question.`));
    else void answer(guess);
  };
  const form = h(
    'form',
    { class: 'predict-form', on: { submit, change: () => stops.keepMore(id, input.get()) } },
    eye.element,
    h(
      'div',
      { class: 'predict-then', hidden: () => !eye.isOver() },
      eye.element && h('p', { class: 'predict-question' }, 'By the figures: which is better for this, and by which?'),
      input.element,
    ),
    h('div', { class: 'controls' }, reveal, skip),
  );

  /** What is right, as a sentence. @param {string | number} right */
  const nameOf = (right) => {
    const name = prediction.name?.(right) ?? input.nameOf(right);
    return name ? `${name}.` : '';
  };

  /** Writes what the run says: what is right comes first. @param {Guessed} outcome */
  function write({ guess, right, answer: words }) {
    const judged = guess === null ? '' : (prediction.judge ?? plainJudge)(guess, right ?? '');
    fill(
      result,
      h('p', { class: 'predict-judged' }, [nameOf(right ?? ''), judged].filter(Boolean).join(' ')),
      h('p', null, words),
    );
    host.dataset.state = 'open';
    eye.lock();
    input.lock(right ?? '');
    form.querySelector('.controls')?.remove();
  }

  /** @param {string | number | null} guess */
  async function answer(guess) {
    const isFocused = form.contains(document.activeElement);
    reveal.disabled = true;
    skip.disabled = true;
    fill(result, h('p', null, 'The run is asked.'));
    try {
      const { right, eye: seen, words } = await prediction.answer(await lab, guess);
      const outcome = { stop: id, question, guess, right, answer: words };
      if (seen) eye.record(question, seen);
      write(outcome);
      stops.record(outcome);
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
  const old = stops.outcomes.get(id);
  input.set(old ? old.guess : stops.more(id));
  if (!old) return;
  write(old);
  // The program may have changed since.
  whenNear(host, async () => {
    try {
      const { right, words } = await prediction.answer(await lab, old.guess);
      write({ ...old, right, answer: words });
      stops.record({ ...old, right, answer: words });
    } catch {
      // What was kept stays.
    }
  });
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
const plainJudge = (guess, right) => (guess === right ? 'As you said.' : 'You said otherwise.');

/**
 * The guess by eye, which comes before the figures. Without one it is over from the beginning.
 * @param {string} id @param {Prediction} prediction @param {Stops} stops
 */
function createEye(id, { eye: choices }, stops) {
  const name = eyeOf(id);
  const isShown = stops.state(name);
  if (!choices)
    return { element: null, get: () => null, isOver: () => true, look: () => false, lock() {}, record() {} };
  const input = inputOf({ kind: 'choice', choices }, 'By eye', stops.pickOf(name));
  input.set(stops.outcomes.get(name)?.guess ?? stops.more(name));
  return {
    element: input.element,
    get: input.get,
    isOver: () => isShown.value,
    /** Shows the figures, if they are not there yet. */
    look() {
      if (isShown.peek()) return false;
      isShown.value = true;
      stops.keepMore(name, input.get());
      input.lock('');
      return true;
    },
    lock() {
      isShown.value = true;
      input.lock(stops.outcomes.get(name)?.right ?? '');
    },
    /** @param {string} question @param {string} right */
    record(question, right) {
      stops.record({ stop: name, question: `By eye: ${question}`, guess: input.get(), right, answer: '' });
    },
  };
}

/**
 * @param {Pick<Prediction, 'kind' | 'choices' | 'label' | 'most'>} prediction @param {string} question
 * @param {Signal<number | null>} picked
 */
function inputOf(prediction, question, picked) {
  const { kind } = prediction;
  if (kind === 'pick')
    return {
      element: null,
      missing: 'Press a place on the surface first.',
      get: () => picked.peek(),
      set(/** @type {unknown} */ guess) {
        if (typeof guess === 'number') picked.value = guess;
      },
      nameOf: () => '',
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
      set(/** @type {unknown} */ guess) {
        if (typeof guess === 'number') box.valueAsNumber = guess;
      },
      nameOf: (/** @type {string | number} */ right) => `It is ${formatCount(Number(right))}`,
      lock: () => {
        box.disabled = true;
      },
    };
  }
  const name = uniqueId('guess');
  const choices = prediction.choices ?? [];
  const radios = choices.map(({ value }) => h('input', { type: 'radio', name, value }));
  const labels = choices.map(({ label }, k) => h('label', { class: 'check' }, radios[k], h('span', null, label)));
  return {
    element: h('fieldset', { class: 'predict-choices' }, h('legend', { class: 'visually-hidden' }, question), labels),
    missing: 'Choose an answer first.',
    get: () => radios.find(({ checked }) => checked)?.value ?? null,
    set(/** @type {unknown} */ guess) {
      for (const radio of radios) radio.checked = radio.value === guess;
    },
    nameOf: (/** @type {string | number} */ right) => choices.find(({ value }) => value === right)?.label ?? '',
    lock(/** @type {string | number} */ right) {
      for (const radio of radios) radio.disabled = true;
      for (const [k, { value }] of choices.entries()) {
        labels[k].toggleAttribute('data-right', value === right);
        if (value === right) fill(labels[k], radios[k], h('span', null, choices[k].label), h('b', null, 'right'));
      }
    },
  };
}
