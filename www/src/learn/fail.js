/** Make it fail: the learner turns several choices at once, and the best and the worst sampling so far are kept. */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h } from '../ui/dom.js';
import { kept } from '../ui/remembered.js';
import { packed } from '../ui/surface-link.js';
import { createTolerance } from './drag.js';
import { reasonOf } from './figure.js';
import { createSelectRow } from './parts.js';
import { blame, isWorse, reasonWhy, share, tryOut, widest } from './verdict.js';
import { FAIL, KNOBS, knobWords, partsOf, partWords, SEED, seedAt, turned, USUAL } from './whatifs.js';

/**
 * @import { Lab, Score, Setup, Try } from './types.js'
 */

const ENDS = ['Best so far', 'Worst so far'];

const nameOf = (/** @type {Lab} */ lab) => `fail.${packed(lab.surface)}`;

/** The best and the worst that this browser has kept of a surface, as the two sides. @param {Lab} lab */
export function keptSides(lab) {
  const [left, right] = kept(nameOf(lab)).text.split('\n');
  return { left, right };
}

/** The best and the worst try on the surface of a lab. */
class Tries {
  /** @type {import('../engine/types.js').Signal<readonly Try[]>} */
  ends = signal([]);
  #lab;

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
  }

  /** Keeps a try if it is the best or the worst so far. @param {string} value */
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

/** Both benches of a page keep the same. @type {WeakMap<Lab, Tries>} */
const all = new WeakMap();

/** @param {Lab} lab */
function triesOf(lab) {
  const known = all.get(lab) ?? new Tries(lab);
  all.set(lab, known);
  return known;
}

/**
 * The controls of the choices, and what is kept and said of them.
 * @param {Lab} lab
 * @param {{ choose: (setup: Setup) => void, isLocked: boolean }} how
 */
export function createFail(lab, { choose, isLocked }) {
  const tries = triesOf(lab);
  const own = signal(USUAL);
  /** The try on the right, and beside it the best so far; beside the best, the worst. @param {string} right */
  const setTo = (right) => {
    if (right === own.peek() || isLocked) return;
    const [best, worst] = tries.ends.peek();
    const left = best?.value === right ? worst?.value : best?.value;
    choose({ what: FAIL, left: left ?? USUAL, right });
  };
  const turn = (/** @type {number} */ k, /** @type {string} */ part) => setTo(turned(own.peek(), k, part));
  const knobs = KNOBS.map(({ name, values, scale }, k) => {
    if (scale) return null;
    const made = createSelectRow({ name, choices: values, change: (part) => turn(k, part) });
    made.select.disabled = isLocked;
    return made;
  });
  const number = createTolerance({
    value: () => Number(partsOf(own.value)[1]),
    change: (to) => turn(1, String(to)),
  });
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
        h('b', null, share(score)),
        h('span', { class: 'quiet' }, knobWords(value)),
      ),
    ),
  );
  const verdict = h('div', { class: 'verdict', role: 'status' });
  return {
    /** The two that are kept, with names. */
    runs: () =>
      tries.ends.peek().map(({ value, run, score }, k) => ({ label: `${ENDS[k]}: ${knobWords(value)}`, run, score })),
    controls: [
      ...knobs.flatMap((knob) => knob?.element ?? []),
      h('p', { class: 'knob' }, 'A particle within ', number, ' · 2r of a child’s place counts as the child.'),
    ],
    kept: keptRow,
    verdict,
    /** @param {Setup} setup */
    follow({ right }) {
      own.value = right;
      for (const [k, knob] of knobs.entries()) knob?.set(partsOf(right)[k]);
      fill(verdict);
    },
    /** The seed of a place that is pressed. @param {readonly number[]} place */
    seed: (place) => turn(SEED, seedAt(place)),
    /** Measures what is shown, and says why it is as it is. @param {Setup} setup */
    async tell({ left, right }) {
      fill(verdict, h('p', { class: 'figure-status' }, 'Each choice is tried with the others put back'));
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
        fill(verdict, verdictWords(mine, usual), list);
      } catch (error) {
        if (own.peek() === right) fill(verdict, reasonOf(error));
      }
    },
  };
}

/** @param {Try} mine @param {Try} usual */
function verdictWords(mine, usual) {
  const isBad = isWorse(mine.score, usual.score);
  if (mine.value === USUAL) return h('p', null, 'This is the sampling of the lesson. Turn something.');
  if (isBad === null) return h('p', null, 'There are too few particles for a share of six neighbours.');
  return h('p', null, h('b', null, isBad ? 'Worse. ' : 'Not worse. '), compared(mine.score, usual.score));
}

/**
 * Two scores in words: by their shares, and by their holes where those are written alike.
 * @param {Score} mine @param {Score} other
 */
function compared(mine, other) {
  if (share(mine) !== share(other))
    return `${share(mine)} have six neighbours, and ${share(other)} in the sampling of the lesson.`;
  const hole = widest(mine) === widest(other) ? 'is as wide' : `is ${widest(mine)}, and ${widest(other)} there`;
  return `${share(mine)} have six neighbours, as in the lesson; the largest hole ${hole}.`;
}

/** @param {Score} own @param {Awaited<ReturnType<typeof blame>>[number]} one */
function blameItem(own, { k, part, usual, score, isHarm }) {
  const figure = share(own) === share(score) ? `the largest hole is ${widest(score)}` : `it is ${share(score)}`;
  const why = isHarm ? reasonWhy(k, part) : 'It does no harm here.';
  return h(
    'li',
    null,
    h('b', null, `${partWords(k, part)}. `),
    h('span', { class: 'why' }, `${why} `),
    `Put back to ${partWords(k, usual).toLowerCase()}, ${figure}.`,
  );
}
