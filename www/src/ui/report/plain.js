/**
 * The four main figures of the report: the number of particles, the variation of their spacing, the largest error, and
 * whether every part of the surface has particles.
 */
import { formatCount, formatSignificant, MISSING } from '../format.js';
import { valueAt, writeWord } from './rows.js';

/** @import { Report } from '../../engine/types.js' */

/** Distances from the surface below this share, a thousandth of a per cent, are negligible. */
const LEAST_SHARE = 1e-5;

/** @param {number} share */
const percent = (share) => `${formatSignificant(100 * share, 2)}\u202f%`;

/**
 * Each figure has a name, a sentence that explains it, and a function that writes it.
 * @type {readonly { label: string, help: string, write: (report: Report) => string }[]}
 */
export const PLAIN = [
  {
    label: 'Particles',
    help: 'Particles on the surface. A smaller radius, or a larger count, gives more.',
    write: ({ count }) => formatCount(count),
  },
  {
    label: 'Spacing variation',
    help: 'How much the distance between neighbours varies, relative to its mean. A perfect lattice has 0 %.',
    write: (report) => {
      // Particles of varying sizes are measured by their own radii.
      const variation = valueAt(report, 'quality.size_variation') ?? valueAt(report, 'quality.spacing_variation');
      return typeof variation === 'number' ? `±\u202f${percent(variation)}` : MISSING;
    },
  },
  {
    label: 'Largest error',
    help: 'The largest distance of a particle from the surface, as a share of the distance between neighbours.',
    write: (report) => {
      const farthest = valueAt(report, 'quality.error_max');
      if (typeof farthest !== 'number') return MISSING;
      return farthest < LEAST_SHARE ? `below ${percent(LEAST_SHARE)}` : percent(farthest);
    },
  },
  {
    label: 'Completeness',
    help: 'Whether every part of the surface in the box has particles. Proven: there is no other part. By search: one smaller than the cells of the search can be missing.',
    write: (report) => {
      const missing = Number(valueAt(report, 'sampled.missing') ?? 0);
      return missing > 0 ? `all but ${formatCount(missing)}` : writeWord(valueAt(report, 'search'));
    },
  },
];
