/** The best and the worst sampling that a learner has found on a surface, and what each of their choices does. */
import { signal } from '@preact/signals-core';
import { kept } from '../ui/remembered.js';
import { packed } from '../ui/surface-link.js';
import { knobSide, partsOf, turned, USUAL } from './knobs.js';
import { scoreAtEnd, verdictOf } from './score.js';

/** @import { Signal } from '../engine/types.js' */
/** @import { Lab, Score, Try } from './types.js' */

/** Whether a score is worse than another by more than chance. @param {Score} a @param {Score} b */
export const isWorse = (a, b) => verdictOf([a, b])?.side === 1;

/** Runs a value of the choices. @param {Lab} lab @param {string} value @returns {Promise<Try>} */
export async function tryOut(lab, value) {
  const run = await knobSide(value).make(lab);
  return { value, run, score: await scoreAtEnd(run) };
}

/**
 * For each choice that differs from the lesson's: the sampling with only this one reset, and the figure by which that
 * is better; null if it is not.
 * @param {Lab} lab @param {Try} own
 */
export async function blame(lab, own) {
  const found = [];
  for (const [k, usual] of partsOf(USUAL).entries()) {
    const part = partsOf(own.value)[k];
    if (Number(part) === Number(usual) || part === usual) continue;
    const { score } = await tryOut(lab, turned(own.value, k, usual));
    const verdict = verdictOf([own.score, score]);
    found.push({ k, part, usual, score, harm: verdict?.side === 1 ? verdict.key : null });
  }
  return found;
}

export class Tries {
  /** The best and the worst, once something was tried. @type {Signal<readonly Try[]>} */
  ends = signal([]);
  #lab;
  #stored;

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
    this.#stored = kept(`fail.${packed(lab.surface)}`);
  }

  /** The values of the best and the worst, also of an earlier visit; none before the first try. */
  values() {
    const found = this.ends.peek().map(({ value }) => value);
    return found.length > 0 ? found : this.#stored.text.split('\n').filter(Boolean);
  }

  /** Stores a try if it is the best or the worst so far. @param {string} value */
  async take(value) {
    const one = await tryOut(this.#lab, value);
    if (one.score.six === null) return one;
    const [best = one, worst = one] = this.ends.peek();
    this.ends.value = [isWorse(best.score, one.score) ? one : best, isWorse(one.score, worst.score) ? one : worst];
    this.#stored.keep(this.values().join('\n'));
    return one;
  }

  /** What is stored, and a value, compared with the lesson's. @param {string} value */
  async compare(value) {
    const old = this.values();
    const usual = await this.take(USUAL);
    for (const one of old) await this.take(one);
    const mine = await this.take(value);
    return { usual, mine, harms: await blame(this.#lab, mine) };
  }
}
