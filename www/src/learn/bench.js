/**
 * The bench of *What if*: the learner changes several choices of the sampling on the right, on any surface. Beside it
 * stands the best sampling so far; what each choice does is said below.
 */
import { computed, signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h } from '../ui/dom.js';
import { createNumber, offerNumber, toleranceNumber } from './drag.js';
import { reasonOf } from './figure.js';
import {
  KNOBS,
  knobDifference,
  knobSide,
  knobWords,
  partsOf,
  partWords,
  SEED,
  seedAt,
  setupOf,
  TOLERANCE,
  turned,
  USUAL,
} from './knobs.js';
import { createMarkSwitch, isMarked } from './marks.js';
import { createPair } from './pair.js';
import { createSelectRow } from './parts.js';
import { verdictOf, written } from './score.js';
import { Tries } from './tries.js';
import { OF_KNOBS } from './whatifs.js';

/** @import { Choice } from '../ui/types.js' */
/** @import { Control, Lab, Score, Setup, Try } from './types.js' */

const ENDS = ['Best so far', 'Worst so far'];

/** Shared by both benches of a page. @type {WeakMap<Lab, Tries>} */
const all = new WeakMap();

/** @param {Lab} lab */
function triesOf(lab) {
  const known = all.get(lab) ?? new Tries(lab);
  all.set(lab, known);
  return known;
}

/**
 * @param {HTMLElement} host
 * @param {Lab} lab
 * @param {{ locks?: readonly Control[], onChoice?: (setup: Setup) => void }} [how]  `locks`: controls that cannot be
 *   changed; `onChoice` receives the learner's choices
 */
export async function createBench(host, lab, { locks = [], onChoice = () => {} } = {}) {
  const { choices, labOn } = await surfacesOf(lab);
  const isLocked = locks.includes('right');
  /** The comparison that is shown or on its way. */
  const setup = signal(setupOf({}));
  const right = computed(() => setup.value.right);
  const tries = computed(() => triesOf(labOn(setup.value.on)));
  let shown = Promise.resolve();
  const pair = createPair(isMarked, createMarkSwitch());
  const verdict = createVerdict();

  /** Shows a comparison; without values it is that of the best and the worst so far. @param {Partial<Setup>} given */
  function open(given) {
    const on = choices.some(({ value }) => value === given.on) ? String(given.on) : '';
    const [best, worst] = triesOf(labOn(on)).values();
    setup.value = setupOf({ left: best, right: worst, ...given, on });
    shown = compare(setup.peek());
    return shown;
  }

  /** @param {Partial<Setup>} given */
  function choose(given) {
    void open(given);
    onChoice(setup.peek());
  }

  /** Shows a try on the right, beside the best so far; the best beside the worst. @param {string} value */
  function turnTo(value) {
    if (isLocked || value === right.peek()) return;
    const [best = USUAL, worst = USUAL] = tries.peek().values();
    choose({ on: setup.peek().on, left: best === value ? worst : best, right: value });
  }
  const turn = (/** @type {number} */ k, /** @type {string} */ part) => turnTo(turned(right.peek(), k, part));

  /** @param {Setup} next */
  async function compare(next) {
    verdict.clear();
    const sides = [next.left, next.right].map(knobSide);
    const make = async () => [await sides[0].make(labOn(next.on)), await sides[1].make(labOn(next.on))];
    // The heads of the table are narrow on a phone.
    const card = () => ({ names: knobDifference(next.left, next.right) });
    await pair.show({ make, labels: () => sides.map(({ label }) => label), card, ...OF_KNOBS });
    const isNow = () => setup.peek() === next;
    if (isNow()) await verdict.tell(tries.peek().compare(next.right), isNow);
  }

  pair.pickWith(isLocked ? null : (place) => turn(SEED, seedAt(place)));
  const tolerance = toleranceNumber({
    value: () => Number(partsOf(right.value)[TOLERANCE]),
    change: (to) => turn(TOLERANCE, String(to)),
  });
  const number = createNumber(tolerance);
  if (isLocked) number.setAttribute('aria-disabled', 'true');
  if (locks.length === 0) offerNumber('knob', { ...tolerance, stage: () => host });
  const surface = createSelectRow({
    name: 'Surface',
    choices: () => choices,
    value: () => setup.value.on,
    change: (on) => choose({ on }),
    isLocked: locks.includes('on'),
  });
  fill(
    host,
    h(
      'div',
      { class: 'controls' },
      surface,
      KNOBS.map((_, k) => knobRow(k, { right: () => right.value, turn, isLocked })),
    ),
    h('p', { class: 'knob' }, 'A particle within ', number, ' of a child’s place counts as the child.'),
    h('div', { class: 'kept', role: 'group', 'aria-label': 'Kept so far' }, () =>
      tries.value.ends.value.map((one, k) => keptButton(one, k, { right: () => right.value, turnTo, isLocked })),
    ),
    verdict.said,
    h('p', { class: 'look' }, OF_KNOBS.look),
    pair.element,
    verdict.reasons,
  );
  return {
    open,
    setup: () => setup.peek(),
    /** The worst sampling found so far on the chosen surface. */
    worst: computed(() => tries.value.ends.value.at(-1)),
    /** Resolves once the runs shown are measured. */
    settled: () => shown,
    /** The runs shown and the stored runs, each once, with names, once they are measured. */
    runs() {
      const ends = tries.peek().ends.peek();
      const kept = ends.map(({ value, run, score }, k) => ({ label: `${ENDS[k]}: ${knobWords(value)}`, run, score }));
      const found = [...kept, ...pair.runs()];
      return found.filter(({ run }, k) => found.findIndex((one) => one.run === run) === k);
    },
  };
}

/**
 * The select of a choice; none for one with a scale. A pressed seed is one of its values while it is chosen.
 * @param {number} k @param {{ right: () => string, turn: (k: number, part: string) => void, isLocked: boolean }} how
 */
function knobRow(k, { right, turn, isLocked }) {
  const { name, values, scale } = KNOBS[k];
  if (scale) return null;
  const part = () => partsOf(right())[k];
  /** @type {() => readonly Choice<string>[]} */
  const choices = () =>
    values.some(({ value }) => value === part()) ? values : [...values, { value: part(), label: part() }];
  return createSelectRow({ name, choices, value: part, change: (to) => turn(k, to), isLocked });
}

/**
 * The best or the worst so far.
 * @param {Try} one @param {number} k
 * @param {{ right: () => string, turnTo: (value: string) => void, isLocked: boolean }} how
 */
const keptButton = ({ value, score }, k, { right, turnTo, isLocked }) =>
  button(
    {
      class: 'plain',
      disabled: isLocked,
      'aria-pressed': () => String(value === right()),
      press: () => turnTo(value),
    },
    h('span', null, ENDS[k]),
    h('b', null, written('six', score), ', hole ', written('hole', score)),
    h('span', { class: 'quiet' }, knobWords(value)),
  );

/**
 * The surfaces on which runs can be compared, and a lab for each: the lesson's surface, and those of the gallery.
 * @param {Lab} lab
 */
async function surfacesOf(lab) {
  const gallery = (await lab.gallery().catch(() => [])).filter(({ formula }) => formula);
  return {
    choices: [
      { value: '', label: 'That of this lesson' },
      ...gallery.map(({ id, name }) => ({ value: id, label: name })),
    ],
    /** @param {string} on */
    labOn(on) {
      const entry = gallery.find(({ id }) => id === on);
      if (!entry) return lab;
      const { formula, parameters, bounds } = entry;
      return lab.on({ formula, parameters, bounds });
    },
  };
}

/** The deciding figures as parts of sentences. */
const SAID = {
  six: (/** @type {string} */ value) => `${value} have six neighbours`,
  hole: (/** @type {string} */ value) => `the largest hole is ${value}`,
  pair: (/** @type {string} */ value) => `the closest pair is at ${value}`,
};

/** What is said of the sampling on the right: the comparison with the lesson's, and what each choice does. */
function createVerdict() {
  const said = h('div', { class: 'said', role: 'status' });
  const reasons = h('div', { class: 'verdict' });
  return {
    said,
    reasons,
    clear() {
      fill(said);
      fill(reasons);
    },
    /** @param {ReturnType<Tries['compare']>} compared @param {() => boolean} isNow  whether it is still asked for */
    async tell(compared, isNow) {
      fill(said, h('p', { class: 'figure-status' }, 'Each choice is tried with the others put back'));
      try {
        const { mine, usual, harms } = await compared;
        if (!isNow()) return;
        fill(said, verdictWords(mine, usual));
        const items = harms.map((one) => blameItem(mine.score, one));
        fill(reasons, items.length > 0 ? h('ul', null, items) : null);
      } catch (error) {
        if (isNow()) fill(said, reasonOf(error));
      }
    },
  };
}

/** @param {Try} mine @param {Try} usual */
function verdictWords(mine, usual) {
  if (mine.value === USUAL) return h('p', null, 'This is the sampling of the lesson. Change something.');
  if (mine.score.six === null) return h('p', null, 'There are too few particles for a share of six neighbours.');
  const verdict = verdictOf([mine.score, usual.score]);
  if (!verdict)
    return h(
      'p',
      null,
      h('b', null, 'No difference beyond chance. '),
      'It cannot be told apart from that of the lesson.',
    );
  const key = /** @type {keyof typeof SAID} */ (verdict.key);
  const [own, other] = [mine, usual].map(({ score }) => written(key, score));
  return h(
    'p',
    null,
    h('b', null, verdict.side === 1 ? 'Worse. ' : 'Better. '),
    `Here ${SAID[key](own)}, in the sampling of the lesson ${other}.`,
  );
}

/** @param {Score} own @param {Awaited<ReturnType<Tries['compare']>>['harms'][number]} one */
function blameItem(own, { k, part, usual, score, harm }) {
  const key = /** @type {keyof typeof SAID} */ (harm ?? 'six');
  const why = harm ? KNOBS[k].why(part) : 'It does no harm beyond chance here.';
  return h(
    'li',
    null,
    h('b', null, `${partWords(k, part)}. `),
    h('span', { class: 'why' }, `${why} `),
    `Put back to ${partWords(k, usual).toLowerCase()}, ${SAID[key](written(key, score))} instead of ${written(key, own)}.`,
  );
}
