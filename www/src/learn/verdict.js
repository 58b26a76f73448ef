/** Judges a sampling against another, and the effect of each choice by a run without it. */
import { scoreAtEnd, verdictOf } from './score.js';
import { FAIL, partsOf, turned, USUAL, whatIfOf } from './whatifs.js';

/** @import { Lab, Score, Try } from './types.js' */

/** Whether a score is worse than another by more than chance. @param {Score} a @param {Score} b */
export const isWorse = (a, b) => verdictOf([a, b])?.side === 1;

/** Runs a setting of the knobs. @param {Lab} lab @param {string} value @returns {Promise<Try>} */
export async function tryOut(lab, value) {
  const run = await whatIfOf(FAIL).make(lab, value);
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
