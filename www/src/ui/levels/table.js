/** The numbers of particles and slot fates of each generation level, and texts about them. */
import { FATES } from '../../engine/columns.js';
import { FATE } from '../../engine/core-numbers.js';
import { formatCount, plural } from '../format.js';

/**
 * @import { Columns, Pattern } from '../../engine/types.js'
 * @import { LevelTable } from './types.js'
 */

/**
 * @param {Pick<Columns, 'count' | 'tally' | 'adaptive' | 'pattern' | 'lastLevel' | 'curves'>} particles
 * @returns {LevelTable}
 */
export function levelTable({ count, tally, adaptive, pattern, lastLevel: last, curves }) {
  // Without particles there are no numbers.
  const fresh = new Uint32Array(last + 1);
  fresh.set(tally.fresh.subarray(0, last + 1));
  const seeds = new Uint32Array(last + 1);
  seeds.set(tally.seeds.subarray(0, last + 1));
  const total = new Uint32Array(last + 1);
  for (let k = 0, sum = 0; k <= last; k += 1) total[k] = sum += fresh[k];
  return { count, last, fresh, total, seeds, fates: tally.fates.slice(), adaptive, pattern, curves };
}

/** Fates of children that were not added, in the order of the description. */
const REST = /** @type {const} */ ([
  ['matched', 'met an existing particle', 'met existing particles'],
  ['outside', 'fell outside the box', 'fell outside the box'],
  ['not_converged', 'did not converge', 'did not converge'],
  ['undefined', 'was undefined', 'were undefined'],
  ['capped', 'was over the limit', 'were over the limit'],
]);

/** The text for `outside` on surfaces of several patches: a child beyond its own patch is not placed. */
const BEYOND = 'fell off the patch or outside the box';

/**
 * Returns the number of particles of a level on a plane around one seed; null for adaptive runs or several seeds.
 * @param {LevelTable} table
 * @param {number} level
 */
export function flatCount({ adaptive, seeds }, level) {
  return !adaptive && level > 0 && seeds.reduce((sum, n) => sum + n, 0) === 1 ? 6 * level : null;
}

/** Returns the short text of a level for the slider. @param {LevelTable} table @param {number} level */
export const shortOf = ({ last, fresh, total, pattern }, level) =>
  `${levelOf(level, last, pattern)}: ${plural(fresh[level], 'particle')}, ${formatCount(total[level])} so far`;

/** @param {number} level @param {number} last @param {Pattern} pattern */
const levelOf = (level, last, pattern) =>
  `${pattern === 'hexagonal' ? 'Level' : 'Round'} ${formatCount(level)} of ${formatCount(last)}`;

/** How the points of a pattern came about. @param {Pattern} pattern @param {number} level */
const drawnOf = (pattern, level) => {
  if (pattern === 'random') return 'Points drawn one by one, each independent of the others. There are no levels.';
  return level === 0
    ? 'Darts thrown at the surface in random order. One that is too near an earlier one is dropped.'
    : 'Darts into the places that are still free, in random order.';
};

/**
 * Describes a level: its particles, and the fates of the proposed children.
 * @param {LevelTable} table @param {number} level
 * @param {number | null} relaxSteps  number of relaxation steps since; null if it is drawn as placed, before them
 */
export function describeLevel(table, level, relaxSteps) {
  const { last, fresh, total, seeds, fates, curves, pattern } = table;
  const flat = flatCount(table, level);
  const plane = flat === null ? '' : ` (on a flat plane ${formatCount(flat)})`;
  const counts = `${formatCount(fresh[level])} new${plane}, ${formatCount(total[level])} so far`;
  const title = `${levelOf(level, last, pattern)} · ${counts}`;
  if (pattern !== 'hexagonal') return { title, text: drawnOf(pattern, level) };
  const moved =
    relaxSteps === null
      ? ' Drawn as placed, before relaxation.'
      : relaxSteps > 0
        ? ` Drawn after ${plural(relaxSteps, 'relaxation step')}.`
        : '';
  if (level === 0) {
    const starts =
      curves.length > 0
        ? `${plural(seeds[0], 'point')} on the ${curves.join(' and ')} or between them, a front from each.`
        : seeds[0] === 1
          ? 'The front starts at one point of the surface.'
          : `${plural(seeds[0], 'point')} of the surface, a front from each.`;
    return { title, text: starts + moved };
  }
  const numberOf = (/** @type {keyof typeof FATE} */ name) => fates[FATES * level + FATE[name]];
  const added = numberOf('added');
  const rest = REST.filter(([name]) => numberOf(name) > 0).map(([name, one, many]) => {
    const words = numberOf(name) === 1 ? one : many;
    return `${formatCount(numberOf(name))} ${curves.length > 0 && name === 'outside' ? BEYOND : words}`;
  });
  const proposed = REST.reduce((sum, [name]) => sum + numberOf(name), added);
  const became = [`${formatCount(added)} added`, ...rest].join(', ');
  const fillers = fresh[level] - added - seeds[level];
  return {
    title,
    text: [
      `Level ${formatCount(level - 1)} proposed ${plural(proposed, 'child', 'children')}: ${became}.`,
      fillers > 0 ? ` ${plural(fillers, 'particle')} filled ${fillers === 1 ? 'a gap' : 'gaps'} at the end.` : '',
      moved,
    ].join(''),
  };
}
