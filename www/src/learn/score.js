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

/** The share of a plane that touching discs in the hexagonal pattern leave open. */
const OPEN = 1 - Math.PI / (2 * Math.sqrt(3));

/** The figures in their order. A press on one that has a place shows the place. @type {readonly ScoreRow[]} */
export const ROWS = [
  {
    key: 'six',
    name: 'Six neighbours',
    means: 'Share of the particles whose cell borders on six others. A cell is what lies nearest to its particle.',
    ideal: 1,
    worse: 'below',
    write: percent,
  },
  {
    key: 'hole',
    name: 'Largest hole, over the ideal',
    means:
      'Radius of the largest empty circle, over that of the ideal pattern: equal particles, as many on as much area.',
    ideal: 1,
    worse: 'above',
    write: ratio,
  },
  {
    key: 'pair',
    name: 'Closest pair, over the ideal',
    means: 'Distance of the two nearest particles, over that of neighbours in the ideal pattern.',
    ideal: 1,
    worse: 'below',
    write: ratio,
  },
  {
    key: 'uncovered',
    name: 'Surface outside all discs',
    means: 'Share of the area that lies farther than r from every particle. Discs that touch leave 9.3 % in a plane.',
    ideal: OPEN,
    worse: 'above',
    isOfDiscs: true,
    write: percent,
  },
  {
    key: 'count',
    name: 'Particles, over A/(2√3 r²)',
    means: 'As many touching discs of radius r as fill the area A in a plane are 1. More than that overlap.',
    ideal: 1,
    worse: null,
    write: ratio,
  },
  {
    key: 'evaluations',
    name: 'Evaluations of f for each',
    means: 'How often f and its gradient were asked for, in the whole run, for each particle.',
    ideal: null,
    worse: 'above',
    write: (value) => formatSignificant(value, 3),
  },
];

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
    disc: radii.reduce((sum, r) => sum + r, 0) / Math.max(1, radii.length),
    places: placesOf(particles, places),
  };
}

/** The score of a run at its end. @param {LabRun} run */
export const scoreAtEnd = ({ lab, end, progress, settings }) =>
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

/** Radii that differ by more than this share are those of other discs. */
const SAME_DISC = 0.005;

/** Whether the discs of two scores are of one size. @param {readonly Score[]} scores */
export const haveSameDiscs = ([one, other]) => Math.abs(one.disc / other.disc - 1) < SAME_DISC;

/**
 * Returns which of several values is better, as they are written; -1 where none is. A value beyond the ideal is bought
 * with more particles, and decides nothing; nor does what is told of discs of two sizes.
 * @param {readonly (number | null)[]} values @param {ScoreRow} row @param {boolean} [isOneDisc]
 */
export function bestOf(values, { ideal, worse, isOfDiscs, write }, isOneDisc = true) {
  if (worse === null || values.some((value) => value === null) || (isOfDiscs && !isOneDisc)) return -1;
  const known = values.map(Number);
  if (new Set(known.map(write)).size < 2) return -1;
  const short = known.map((value) => (worse === 'above' ? value - (ideal ?? 0) : (ideal ?? 0) - value));
  return Math.min(...short) < 0 ? -1 : short.indexOf(Math.min(...short));
}
