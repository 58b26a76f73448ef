/** The figures of the charts: fates of each level, energy and longest move of each relaxation step. */
import { FATES } from '../../engine/columns.js';
import { FATE } from '../../engine/core-numbers.js';

/** @import { LevelTable } from './types.js' */

/** Fates of proposed children in the order of stacking, with their names. */
const STACKED = /** @type {const} */ ([
  ['added', 'added'],
  ['matched', 'met another'],
  ['outside', 'outside'],
  ['not_converged', 'not converged'],
  ['undefined', 'undefined'],
  ['capped', 'over the limit'],
]);

/**
 * Returns the fates of the children that were proposed for each level, one row per fate that occurs.
 * @param {LevelTable} table
 * @returns {{ fate: string, name: string, counts: number[] }[]}
 */
export const fatesOf = ({ fates, last }) =>
  STACKED.map(([fate, name]) => ({
    fate,
    name,
    counts: Array.from({ length: last + 1 }, (_, level) => (level === 0 ? 0 : fates[FATES * level + FATE[fate]])),
  })).filter(({ counts }) => counts.some((count) => count > 0));

/**
 * Returns the longest move of each relaxation step, in radii.
 * @param {readonly ArrayLike<number>[]} past  positions before each step
 * @param {ArrayLike<number>} now  after the last one
 * @param {ArrayLike<number>} radii
 */
export function movesOf(past, now, radii) {
  return past.map((from, step) => {
    const to = past[step + 1] ?? now;
    let most = 0;
    for (let i = 0; 3 * i + 2 < from.length; i += 1) {
      const [x, y, z] = [0, 1, 2].map((k) => to[3 * i + k] - from[3 * i + k]);
      most = Math.max(most, Math.hypot(x, y, z) / radii[i]);
    }
    return most;
  });
}
