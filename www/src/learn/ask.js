/**
 * Asks a question: takes a guess for each of its parts, round by round, and shows the answer from the run. Nothing is
 * scored or sent, and every question may be skipped.
 */
import { button } from '../ui/button.js';
import { fill, h, uniqueId } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { reasonOf, whenNear } from './figure.js';
import { partsOf, stopOf } from './questions.js';
import { HEAD_PX } from './stops.js';

/**
 * @import { Lab, Part, Question, Stops } from './types.js'
 */

/** A guess counts as close within this share of the number. */
const CLOSE = 0.1;

/** The name under which figures find out whether the first round of a question is over. @param {string} id */
export const seenOf = (id) => `${id}-seen`;

/**
 * Puts a question before the content of an element, and its form after it. A stored answer is shown at once, and
 * computed again when the question comes near the window.
 * @param {HTMLElement} host @param {string} id @param {Question<any>} about
 * @param {{ lab: Promise<Lab>, stops: Stops }} context
 */
export function mountQuestion(host, id, about, { lab, stops }) {
  const { question, ask, words, rounds } = about;
  /** Whether the last round has begun. */
  const isSeen = rounds.length > 1 ? stops.state(seenOf(id)) : null;
  const isLast = () => isSeen === null || isSeen.value;
  if (isSeen && stops.more(seenOf(id))) isSeen.value = true;
  const parts = enter(id, about, stops);
  const present = () => parts.filter(({ isFirst }) => isSeen === null || isFirst !== isLast());
  const result = h('div', { class: 'predict-result', role: 'status', tabindex: '-1' });
  const reveal = button({ type: 'submit', class: 'primary' }, () => (isLast() ? 'Reveal' : 'Show the figures'));
  const skip = button({ class: 'plain', press: () => void answer(true) }, 'Skip');
  const keep = () => {
    for (const { stop, input } of parts) if (input.get() !== null) stops.keepMore(stop, input.get());
  };
  /** @param {SubmitEvent} event */
  function submit(event) {
    event.preventDefault();
    const open = present().find(({ input }) => input.get() === null);
    if (open) return fill(result, h('p', null, `${open.input.missing} You can also skip the question.`));
    fill(result);
    if (isLast()) return void answer(false);
    for (const { input } of present()) input.lock(null);
    stops.keepMore(seenOf(id), true);
    if (isSeen) isSeen.value = true;
  }
  const form = h(
    'form',
    { class: 'predict-form', on: { submit, change: keep } },
    parts.map(({ input, isFirst }) =>
      h('div', { class: 'predict-part', hidden: () => !isFirst && !isLast() }, input.element),
    ),
    h('div', { class: 'controls' }, reveal, skip),
  );

  /**
   * Writes the answer, beginning with the right value.
   * @param {readonly (string | number | undefined)[]} right @param {string} said
   */
  function write(right, said) {
    const told = parts.map(({ part, stop, input }, k) => {
      const value = right[k] ?? '';
      const guess = stops.outcomes.get(stop)?.guess ?? null;
      input.lock(value);
      return [part.legend, input.nameOf(value), guess === null ? '' : judge(part, guess, value)]
        .filter(Boolean)
        .join(' ');
    });
    fill(
      result,
      told.filter(Boolean).map((line) => h('p', { class: 'predict-judged' }, line)),
      h('p', null, said),
    );
    host.dataset.state = 'open';
    form.querySelector('.controls')?.remove();
  }

  /** Gets the answer from the run. @param {readonly (string | number | null)[]} guesses of the parts */
  async function asked(guesses) {
    const facts = await ask(await lab);
    const right = parts.map(({ part }) => part.right(facts));
    const said = words(facts).filter(Boolean).join(' ');
    for (const [k, { stop, asked: question }] of parts.entries())
      stops.record({ stop, question, guess: guesses[k], right: right[k], answer: said });
    write(right, said);
  }

  /** @param {boolean} isSkipped */
  async function answer(isSkipped) {
    const isFocused = form.contains(document.activeElement);
    reveal.disabled = true;
    skip.disabled = true;
    // Guesses from a completed round stay.
    const guesses = parts.map(({ input, isFirst }) => (isSkipped && !(isFirst && isSeen?.peek()) ? null : input.get()));
    fill(result, h('p', null, 'Computing the answer'));
    try {
      await asked(guesses);
      // The pressed button no longer exists.
      if (isFocused) result.focus({ preventScroll: true });
      if (isSeen) isSeen.value = true;
      stops.open(id);
      showFigure(host);
    } catch (error) {
      fill(result, h('p', null, reasonOf(error)));
      reveal.disabled = false;
      skip.disabled = false;
    }
  }
  host.prepend(h('p', { class: 'predict-question' }, question));
  host.append(form, result);
  for (const { stop, input } of parts) input.set(stops.outcomes.get(stop)?.guess ?? stops.more(stop));
  const old = parts.map(({ stop }) => stops.outcomes.get(stop));
  if (isSeen?.peek()) for (const { input, isFirst } of parts) if (isFirst) input.lock(null);
  if (!old[0]) return;
  if (isSeen) isSeen.value = true;
  stops.open(id);
  write(
    old.map((one) => one?.right),
    old[0].answer,
  );
  // The program may have changed since. If the run fails, the stored answer stays.
  whenNear(host, () => asked(old.map((one) => one?.guess ?? null)).catch(() => {}));
}

/**
 * The parts of a question with their inputs, which are saved with a learner's work.
 * @param {string} id @param {Question<any>} about @param {Stops} stops
 */
const enter = (id, about, stops) =>
  partsOf(about).map((part) => {
    const stop = stopOf(id, part);
    const asked = part.legend ? `${about.question} ${part.legend}` : about.question;
    const input = inputOf(part, about.question);
    stops.entries.set(stop, { question: asked, get: input.get });
    return { part, stop, asked, input, isFirst: about.rounds[0].includes(part) };
  });

/**
 * The comment on a guess.
 * @param {Part<any>} part
 * @param {string | number} guess
 * @param {string | number} right
 */
function judge({ kind, choices = [] }, guess, right) {
  if (kind === 'choice')
    return guess === right
      ? 'As you said.'
      : `You said: ${choices.find(({ value }) => value === guess)?.label ?? guess}.`;
  if (guess === right) return 'Exactly.';
  const far = Math.abs(Number(guess) - Number(right));
  return far <= CLOSE * Number(right) ? 'Close.' : `You said ${formatCount(guess)}.`;
}

/**
 * Scrolls the figure of a question into view, and as much of the answer as fits.
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

/**
 * The input of a part. `lock` ends the input and shows the right answer, unless it is null.
 * @param {Part<any>} part @param {string} question
 */
function inputOf({ kind, legend, choices = [], label = 'Your guess', most = 9999 }, question) {
  if (kind === 'number') {
    const id = uniqueId('guess');
    const box = h('input', { class: 'box', id, type: 'number', inputmode: 'numeric', min: 0, max: most, step: 1 });
    return {
      element: h('div', { class: 'predict-number' }, h('label', { for: id }, label), box),
      missing: 'Write a number first.',
      get: () => (box.value === '' || !box.checkValidity() ? null : Number(box.value)),
      set(/** @type {unknown} */ guess) {
        if (typeof guess === 'number') box.valueAsNumber = guess;
      },
      nameOf: (/** @type {string | number} */ right) => `It is ${formatCount(Number(right))}.`,
      lock(/** @type {string | number | null} */ _right) {
        box.disabled = true;
      },
    };
  }
  const name = uniqueId('guess');
  const radios = choices.map(({ value }) => h('input', { type: 'radio', name, value }));
  const labels = choices.map((choice, k) => h('label', { class: 'check' }, radios[k], h('span', null, choice.label)));
  return {
    element: h(
      'fieldset',
      { class: 'predict-choices' },
      h('legend', { class: legend ? null : 'visually-hidden' }, legend ?? question),
      labels,
    ),
    missing: 'Choose an answer first.',
    get: () => radios.find(({ checked }) => checked)?.value ?? null,
    set(/** @type {unknown} */ guess) {
      for (const radio of radios) radio.checked = radio.value === guess;
    },
    nameOf(/** @type {string | number} */ right) {
      const found = choices.find(({ value }) => value === right);
      return found ? `${found.label}.` : '';
    },
    lock(/** @type {string | number | null} */ right) {
      for (const radio of radios) radio.disabled = true;
      for (const [k, { value, label: words }] of choices.entries()) {
        labels[k].toggleAttribute('data-right', value === right);
        if (value === right) fill(labels[k], radios[k], h('span', null, words), h('b', null, 'right'));
      }
    },
  };
}
