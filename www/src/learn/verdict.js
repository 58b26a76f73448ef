/** What a sampling is worth against another, and what each choice does to it, told by a run in which it is put back. */
import { MISSING } from '../ui/format.js';
import { ROWS, scoreAtEnd } from './score.js';
import { FAIL, partsOf, turned, USUAL, whatIfOf } from './whatifs.js';

/** @import { Lab, Score, Try } from './types.js' */

const [SIX, HOLE] = ROWS;
/** @param {Score} score */
export const share = ({ six }) => (six === null ? MISSING : SIX.write(six));
/** @param {Score} score */
export const widest = ({ hole }) => (hole === null ? MISSING : HOLE.write(hole));

/**
 * Whether one score is worse than another: fewer particles have six neighbours, or as many, as they are written, and
 * the largest hole is larger. Null where a share is undefined.
 * @param {Score} a @param {Score} b
 */
export function isWorse(a, b) {
  if (a.six === null || b.six === null) return null;
  if (SIX.write(a.six) !== SIX.write(b.six)) return a.six < b.six;
  return Number(a.hole) > Number(b.hole) && HOLE.write(Number(a.hole)) !== HOLE.write(Number(b.hole));
}

/** What a choice does to the sampling. @param {number} k @param {string} part */
export function reasonWhy(k, part) {
  switch (k) {
    case 0:
      return 'The newest particle comes next, so the front runs off like a thread. Threads meet far more often than rings do, and every meeting is a seam, where particles have five neighbours or seven and holes stay open.';
    case 1:
      return Number(part) < 0.7
        ? 'Where rows meet, a particle that is off by more than this does not count as the child. A second one is put beside it, and the particles crowd.'
        : 'A child counts as matched by a particle far from its place. Nothing is put there, and the hole stays open.';
    case 2:
      return part === '0'
        ? 'Nothing is pushed into the holes that placing leaves beside its seams, and pairs stay too near.'
        : 'Pushed that long, some particles leave the rows that the front laid.';
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
 * For each choice that is not that of the lesson: what the sampling is with this one alone put back, and whether the
 * choice does harm.
 * @param {Lab} lab @param {Try} own
 */
export async function blame(lab, own) {
  const found = [];
  for (const [k, usual] of partsOf(USUAL).entries()) {
    const part = partsOf(own.value)[k];
    if (Number(part) === Number(usual) || part === usual) continue;
    const { score } = await tryOut(lab, turned(own.value, k, usual));
    found.push({ k, part, usual, score, isHarm: isWorse(own.score, score) });
  }
  return found;
}
