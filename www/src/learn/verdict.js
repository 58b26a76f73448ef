/** What a sampling is worth against another, and what each choice does to it, told by a run in which it is put back. */
import { scoreAtEnd, verdictOf } from './score.js';
import { FAIL, partsOf, turned, USUAL, whatIfOf } from './whatifs.js';

/** @import { Lab, Score, Try } from './types.js' */

/** Whether one score is worse than another, by more than chance. @param {Score} a @param {Score} b */
export const isWorse = (a, b) => verdictOf([a, b])?.side === 1;

/** What a run of knobs gives. @param {Lab} lab @param {string} value @returns {Promise<Try>} */
export async function tryOut(lab, value) {
  const run = await whatIfOf(FAIL).make(lab, value);
  return { value, run, score: await scoreAtEnd(run) };
}

/**
 * For each choice that is not that of the lesson: what the sampling is with this one alone put back, and by which
 * figure that is better; null if it is not.
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
