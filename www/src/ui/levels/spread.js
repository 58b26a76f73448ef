/** The evenness of the shown particles: nearest distances, and numbers of neighbours. */
import { between, createGrid } from '../neighbours.js';

/**
 * Distances over 2r that the histogram spans, and its number of bins; values outside count in the first or last bin.
 */
export const SPAN = /** @type {const} */ ([0.6, 1.2]);
export const BINS = 24;
/** Numbers of neighbours that have a bar; others count in the first or last bar. */
export const NEIGHBOURS = /** @type {const} */ ([3, 9]);

/** Side of the cells for the search of neighbours, over the mean radius, and the largest number of rings searched. */
const CELL = 2.2;
const MOST_RINGS = 8;

/**
 * Returns the distance of each chosen particle to the nearest other one, over the diameter of its disc; infinite if
 * there is none within eight cells.
 * @param {ArrayLike<number>} positions
 * @param {ArrayLike<number>} radii
 * @param {readonly number[]} chosen  their numbers
 */
export function nearestOver(positions, radii, chosen) {
  const cell = (CELL * chosen.reduce((sum, i) => sum + radii[i], 0)) / Math.max(1, chosen.length);
  const grid = createGrid(positions, chosen, cell);
  return Float32Array.from(chosen, (i) => {
    let least = Infinity;
    // A particle outside the rings searched so far is farther away than their width.
    for (let ring = 0; ring <= MOST_RINGS && least > Math.max(0, ring - 1) * cell; ring += 1)
      for (const j of grid.around(i, ring)) if (j !== i) least = Math.min(least, between(positions, i, j));
    return least / (2 * radii[i]);
  });
}

/** Counts distances over 2r in bins. @param {ArrayLike<number>} nearest */
export function nearestBins(nearest) {
  /** @type {number[]} */
  const counts = new Array(BINS).fill(0);
  const [low, high] = SPAN;
  for (let i = 0; i < nearest.length; i += 1) {
    if (!Number.isFinite(nearest[i])) continue;
    const bin = Math.floor(((nearest[i] - low) / (high - low)) * BINS);
    counts[Math.min(BINS - 1, Math.max(0, bin))] += 1;
  }
  return counts;
}

/**
 * Counts the particles by their number of neighbours, with the share that have six; null if no number is known.
 * Duplicates, which have none, get no bar.
 * @param {ArrayLike<number> | null} valence
 */
export function degreeBins(valence) {
  if (!valence || valence.length === 0) return null;
  const [least, most] = NEIGHBOURS;
  /** @type {number[]} */
  const counts = new Array(most - least + 1).fill(0);
  for (let i = 0; i < valence.length; i += 1) {
    if (valence[i] === 0) continue;
    counts[Math.min(most, Math.max(least, valence[i])) - least] += 1;
  }
  return { counts, six: counts[6 - least] / valence.length };
}

/**
 * Returns the number of particles of one radius in a perfect hexagonal lattice on an area: A/(2√3 r²).
 * @param {number} area @param {number} radius
 */
export const hexagonalCount = (area, radius) => area / (2 * Math.sqrt(3) * radius ** 2);
