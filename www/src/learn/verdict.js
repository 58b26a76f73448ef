/** What a sampling is worth against another, and what each choice does to it, told by a run in which it is put back. */
import { MISSING } from '../ui/format.js';
import { rowOf, scoreAtEnd, verdictOf } from './score.js';
import { FAIL, partsOf, turned, USUAL, whatIfOf } from './whatifs.js';

/** @import { Lab, Score, Try } from './types.js' */

/** A figure of a score as it is written. @param {'six' | 'hole' | 'pair'} key @param {Score} score */
export const written = (key, score) => (score[key] === null ? MISSING : rowOf(key).write(Number(score[key])));

/** Whether one score is worse than another, by more than chance. @param {Score} a @param {Score} b */
export const isWorse = (a, b) => verdictOf([a, b])?.side === 1;

/** What a choice does to the sampling. @param {number} k @param {string} part */
export function reasonWhy(k, part) {
  switch (k) {
    case 0:
      return 'The newest particle comes next, so the front runs off like a thread. Threads meet far more often than rings do, and every meeting is a seam.';
    case 1:
      return Number(part) < 0.7
        ? 'Where rows meet, a particle that is off by more than this does not count as the child. A second one is put beside it, and the particles crowd.'
        : 'A child counts as matched by a particle far from its place. Nothing is put there, and the hole stays open.';
    case 2:
      return part === '0'
        ? 'Nothing is pushed into the holes that placing leaves beside its seams, and pairs stay too near.'
        : 'Pushed that long, particles go farther from where the front has put them.';
    default:
      return 'Another seed moves the rings, and the seams with them. Their number hardly changes.';
  }
}

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
