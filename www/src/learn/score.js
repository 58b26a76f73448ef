/** The figures that decide between two runs, or two moments of one: those of the sampler's own report. */
import { distance, triple } from '../engine/vector.js';
import { formatFixed, formatSignificant } from '../ui/format.js';

/**
 * @import { LessonParticles, Measures } from '../engine/types.js'
 * @import { Lab, LabRun, Score, ScorePlace, ScoreRow } from './types.js'
 */

/** @param {number} share */
const percent = (share) => `${formatFixed(100 * share, 1)} %`;
/** @param {number} value */
const ratio = (value) => formatFixed(value, 2);

/** The figures in their order. A press on one that has a place shows the place. @type {readonly ScoreRow[]} */
export const ROWS = [
  { key: 'six', name: 'Six neighbours', best: Infinity, write: percent },
  { key: 'hole', name: 'Largest hole, over the ideal', best: 0, write: ratio },
  { key: 'uncovered', name: 'Surface outside all discs', best: 0, write: percent },
  { key: 'pair', name: 'Closest pair, over the ideal', best: Infinity, write: ratio },
  { key: 'count', name: 'Particles, over A/(2√3 r²)', best: 1, write: ratio },
  { key: 'evaluations', name: 'Evaluations of f for each', best: 0, write: (value) => formatSignificant(value, 3) },
];

/** What the row of the count compares with. */
export const COUNT_WORDS =
  'In the densest packing a disc of radius r takes a hexagon of area 2√3 r². So A/(2√3 r²) of them would fill an area A in a plane.';

/**
 * Measures particles. Those of many sizes are measured each against its own.
 * @param {Lab} lab @param {LessonParticles} particles
 * @param {{ evaluations: number, isAdaptive: boolean }} how  `evaluations`: of f in the whole run
 * @returns {Promise<Score>}
 */
export async function scoreOf(lab, particles, { evaluations, isAdaptive }) {
  const { quality, places } = await lab.measure(particles, isAdaptive);
  const { radii } = particles;
  return {
    six: quality?.six ?? null,
    hole: (isAdaptive ? quality?.cover_local : quality?.cover) ?? null,
    uncovered: quality?.uncovered ?? null,
    pair: (isAdaptive ? quality?.overlap_min : quality?.rho) ?? null,
    // The area that hexagonal cells of these sizes would take, over that of the surface.
    count: quality ? (2 * Math.sqrt(3) * radii.reduce((sum, r) => sum + r * r, 0)) / quality.area : null,
    evaluations: evaluations / Math.max(1, radii.length),
    places: placesOf(particles, places),
  };
}

/** The score of a run at its end. @param {Lab} lab @param {LabRun} run */
export const scoreAtEnd = (lab, { end, progress, settings }) =>
  scoreOf(lab, end, { evaluations: progress.evaluations, isAdaptive: settings.sampling === 'adaptive' });

/**
 * The largest hole, with the particle beside it, and the closest pair.
 * @param {LessonParticles} particles @param {Measures['places']} places
 */
export function placesOf({ positions, normals, radii }, { holes, pairs }) {
  const beside = holes[0] ? nearestTo(positions, holes[0].position) : -1;
  /** @type {ScorePlace | null} */
  let hole = null;
  /** @type {ScorePlace | null} */
  let pair = null;
  if (holes[0]) hole = { places: [holes[0].position], radius: holes[0].radius, normal: triple(normals, beside) };
  if (pairs[0]) {
    const both = pairs[0].particles;
    pair = { places: both.map((i) => triple(positions, i)), radius: radii[both[0]], normal: triple(normals, both[0]) };
  }
  return { hole, pair, beside };
}

/** @param {ArrayLike<number>} positions @param {readonly number[]} place */
function nearestTo(positions, place) {
  let [best, least] = [0, Infinity];
  for (let i = 0; 3 * i < positions.length; i += 1) {
    const away = distance(place, triple(positions, i));
    if (away < least) [best, least] = [i, away];
  }
  return best;
}

/** The figures of a score by their names, as numbers. @param {Score} score */
export const namedFigures = (score) => Object.fromEntries(ROWS.map(({ key, name }) => [name, score[key]]));

/**
 * Returns which of several values is the best, as they are written; -1 where they are alike.
 * @param {readonly (number | null)[]} values @param {ScoreRow} row
 */
export function bestOf(values, { best, write }) {
  if (values.some((value) => value === null)) return -1;
  const known = values.map(Number);
  if (new Set(known.map(write)).size < 2) return -1;
  const far = known.map((value) => (best === Infinity ? -value : Math.abs(value - best)));
  return far.indexOf(Math.min(...far));
}
