/** Make it fail: the learner changes several choices at once; the best and the worst sampling so far are stored. */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h } from '../ui/dom.js';
import { kept } from '../ui/remembered.js';
import { packed } from '../ui/surface-link.js';
import { createNumber, toleranceNumber } from './drag.js';
import { reasonOf } from './figure.js';
import { createSelectRow } from './parts.js';
import { verdictOf, written } from './score.js';
import { blame, isWorse, tryOut } from './verdict.js';
import { FAIL, KNOBS, knobWords, partsOf, partWords, SEED, seedAt, TOLERANCE, turned, USUAL } from './whatifs.js';

/**
 * @import { Lab, Score, Setup, Try } from './types.js'
 */

const ENDS = ['Best so far', 'Worst so far'];

const nameOf = (/** @type {Lab} */ lab) => `fail.${packed(lab.surface)}`;

/** The best and the worst value stored for a surface, as the two sides. @param {Lab} lab */
export function keptSides(lab) {
  const [left, right] = kept(nameOf(lab)).text.split('\n');
  return { left, right };
}

/** The best and the worst try on a lab's surface. */
class Tries {
  /** @type {import('../engine/types.js').Signal<readonly Try[]>} */
  ends = signal([]);
  #lab;

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
  }

  /** Stores a try if it is the best or the worst so far. @param {string} value */
  async take(value) {
    const one = await tryOut(this.#lab, value);
    if (one.score.six === null) return one;
    const [best = one, worst = one] = this.ends.peek();
    this.ends.value = [isWorse(best.score, one.score) ? one : best, isWorse(one.score, worst.score) ? one : worst];
    kept(nameOf(this.#lab)).keep(
      this.ends
        .peek()
        .map((end) => end.value)
        .join('\n'),
    );
    return one;
  }
}

/** Shared by both benches of a page. @type {WeakMap<Lab, Tries>} */
const all = new WeakMap();

/** @param {Lab} lab */
function triesOf(lab) {
  const known = all.get(lab) ?? new Tries(lab);
  all.set(lab, known);
  return known;
}

/**
 * The controls of the choices, with the stored tries and the comments.
 * @param {Lab} lab
 * @param {{ choose: (setup: Setup) => void, isLocked: boolean, on: string }} how  `on`: the name of the surface
 */
export function createFail(lab, { choose, isLocked, on }) {
  const tries = triesOf(lab);
  const own = signal(USUAL);
  /** Shows a try on the right, and the best so far on the left; next to the best, the worst. @param {string} right */
  const setTo = (right) => {
    if (right === own.peek() || isLocked) return;
    const [best, worst] = tries.ends.peek();
    const left = best?.value === right ? worst?.value : best?.value;
    choose({ what: FAIL, on, left: left ?? USUAL, right });
  };
  const turn = (/** @type {number} */ k, /** @type {string} */ part) => setTo(turned(own.peek(), k, part));
  const knobs = KNOBS.map(({ name, values, scale }, k) => {
    if (scale) return null;
    const made = createSelectRow({ name, choices: values, change: (part) => turn(k, part) });
    made.select.disabled = isLocked;
    return made;
  });
  const number = createNumber(
    toleranceNumber({
      value: () => Number(partsOf(own.value)[TOLERANCE]),
      change: (to) => turn(TOLERANCE, String(to)),
    }),
  );
  if (isLocked) number.setAttribute('aria-disabled', 'true');
  const keptRow = h('div', { class: 'kept', role: 'group', 'aria-label': 'Kept so far' }, () =>
    tries.ends.value.map(({ value, score }, k) =>
      button(
        {
          class: 'plain',
          disabled: isLocked,
          'aria-pressed': String(value === own.value),
          press: () => setTo(value),
        },
        h('span', null, ENDS[k]),
        h('b', null, written('six', score), ', hole ', written('hole', score)),
        h('span', { class: 'quiet' }, knobWords(value)),
      ),
    ),
  );
  /** The comparison, next to the controls, and the reasons, below the pictures. */
  const said = h('div', { class: 'said', role: 'status' });
  const verdict = h('div', { class: 'verdict' });
  return {
    /** The two stored runs, with names. */
    runs: () =>
      tries.ends.peek().map(({ value, run, score }, k) => ({ label: `${ENDS[k]}: ${knobWords(value)}`, run, score })),
    controls: [
      ...knobs.flatMap((knob) => knob?.element ?? []),
      h('p', { class: 'knob' }, 'A particle within ', number, ' of a child’s place counts as the child.'),
    ],
    kept: keptRow,
    said,
    verdict,
    /** @param {Setup} setup */
    follow({ right }) {
      own.value = right;
      for (const [k, knob] of knobs.entries()) knob?.set(partsOf(right)[k]);
      fill(said);
      fill(verdict);
    },
    /** Chooses the seed at a pressed point. @param {readonly number[]} place */
    seed: (place) => turn(SEED, seedAt(place)),
    /** Measures the setup shown, and explains its result. @param {Setup} setup */
    async tell({ left, right }) {
      fill(said, h('p', { class: 'figure-status' }, 'Each choice is tried with the others put back'));
      try {
        const usual = await tries.take(USUAL);
        for (const value of [left, ...Object.values(keptSides(lab))]) if (value) await tries.take(value);
        const mine = await tries.take(right);
        const told = await blame(lab, mine);
        if (own.peek() !== right) return;
        const list =
          told.length > 0
            ? h(
                'ul',
                null,
                told.map((one) => blameItem(mine.score, one)),
              )
            : null;
        fill(said, verdictWords(mine, usual));
        fill(verdict, list);
      } catch (error) {
        if (own.peek() === right) fill(said, reasonOf(error));
      }
    },
  };
}

/** The deciding figures as parts of sentences. */
const SAID = {
  six: (/** @type {string} */ value) => `${value} have six neighbours`,
  hole: (/** @type {string} */ value) => `the largest hole is ${value}`,
  pair: (/** @type {string} */ value) => `the closest pair is at ${value}`,
};

/** @param {Try} mine @param {Try} usual */
function verdictWords(mine, usual) {
  if (mine.value === USUAL) return h('p', null, 'This is the sampling of the lesson. Turn something.');
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

/** @param {Score} own @param {Awaited<ReturnType<typeof blame>>[number]} one */
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
