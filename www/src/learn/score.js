/**
 * The figures that decide between two runs, or two moments of one run; they come from the sampler's own report.
 */
import { clamp, dot, nearest, triple } from '../engine/vector.js';
import { formatCount, formatFixed, formatSignificant, MISSING } from '../ui/format.js';
import { between, createGrid } from '../ui/neighbours.js';

/**
 * @import { LessonParticles, Measures } from '../engine/types.js'
 * @import { Lab, LabRun, Score, ScoreFigures, ScorePlace, ScoreRow } from './types.js'
 */

/** @param {number} share */
const percent = (share) => `${formatFixed(100 * share, 1)} %`;
/** @param {number} value */
const ratio = (value) => formatFixed(value, 2);

/** @param {number} share */
const points = (share) => `${formatFixed(100 * share, 1)} points`;

/**
 * The figures in order. Pressing a figure with a place shows the place. Its chance is the largest difference among ten
 * seeds of one method with particles of one size, over several methods and surfaces. The share with six neighbours is a
 * mean over all particles, so its chance falls with the square root of their number.
 * @type {readonly ScoreRow[]}
 */
export const ROWS = [
  {
    key: 'count',
    name: 'Particles',
    ideal: null,
    worse: null,
    digits: 0,
    write: formatCount,
  },
  {
    key: 'six',
    name: 'Six neighbours',
    ideal: 1,
    worse: 'below',
    chance: ({ count }) => 2 / Math.sqrt(Number(count)),
    digits: 3,
    write: percent,
    writeChance: points,
  },
  {
    key: 'hole',
    name: 'Largest hole, over the ideal',
    ideal: 1,
    worse: 'above',
    chance: () => 0.15,
    digits: 2,
    write: ratio,
  },
  {
    key: 'pair',
    name: 'Closest pair, over the ideal',
    ideal: 1,
    worse: 'below',
    chance: () => 0.08,
    digits: 2,
    write: ratio,
  },
  {
    key: 'uncovered',
    name: 'Surface outside all discs',
    isRare: true,
    ideal: null,
    worse: null,
    digits: 3,
    write: percent,
  },
  {
    key: 'evaluations',
    name: 'Evaluations of f per particle',
    isRare: true,
    ideal: null,
    worse: 'above',
    chance: ({ evaluations }) => 0.03 * Number(evaluations),
    digits: 1,
    write: (value) => formatSignificant(value, 3),
  },
  {
    key: 'gap',
    name: 'Widest gap to a mesh, in ‰ of the surface’s size',
    isRare: true,
    ideal: null,
    worse: 'above',
    chance: ({ gap }) => 0.25 * Number(gap),
    digits: 4,
    write: (value) => formatFixed(1000 * value, 1),
  },
];

/** @param {keyof ScoreFigures} key */
export const rowOf = (key) => /** @type {ScoreRow} */ (ROWS.find((row) => row.key === key));

/**
 * Measures particles; particles of many sizes each relative to their own size.
 * @param {Lab} lab @param {LessonParticles} particles
 * @param {{ evaluations: number, isAdaptive: boolean }} how  `evaluations`: of f in the whole run
 * @returns {Promise<Score>}
 */
export async function scoreOf(lab, particles, { evaluations, isAdaptive }) {
  const { quality, places, valence } = await lab.measure(particles, isAdaptive);
  const { radii } = particles;
  return {
    six: quality?.six_neighbours ?? null,
    hole: (isAdaptive ? quality?.cover_local : quality?.cover) ?? null,
    uncovered: quality?.uncovered ?? null,
    pair: (isAdaptive ? quality?.overlap_min : quality?.rho) ?? null,
    gap: gapOf(particles),
    count: radii.length,
    evaluations: evaluations / Math.max(1, radii.length),
    places: placesOf(particles, places),
    valence,
  };
}

/**
 * Two particles are adjacent if their distance, divided by the sum of their radii, is at most this.
 */
const BESIDE = 1.4;

/**
 * The widest gap between the surface and the edges of a mesh of its particles, divided by the longest side of their
 * box. Over an edge the surface is an arc that turns like the normals at its ends. Null without an edge.
 * @param {LessonParticles} particles
 */
export function gapOf({ positions, normals, radii }) {
  const grid = createGrid(positions, radii.keys(), 2 * BESIDE * Math.max(...radii));
  let widest = -1;
  for (const i of radii.keys())
    for (const ring of [0, 1])
      for (const j of grid.around(i, ring)) {
        const far = between(positions, i, j);
        if (j <= i || far > BESIDE * (radii[i] + radii[j])) continue;
        const turn = Math.acos(clamp(dot(triple(normals, i), triple(normals, j)), -1, 1));
        // If the normals differ by more than a right angle, the particles are on different sheets.
        if (turn < Math.PI / 2) widest = Math.max(widest, (far / 2) * Math.tan(turn / 4));
      }
  const side = (/** @type {number} */ axis) => {
    const values = positions.filter((_, k) => k % 3 === axis);
    return values.reduce((most, v) => Math.max(most, v), -Infinity) - values.reduce((l, v) => Math.min(l, v), Infinity);
  };
  return widest < 0 ? null : widest / Math.max(side(0), side(1), side(2));
}

/** The score of a run at its end. @param {LabRun} run */
export const scoreAtEnd = ({ lab, end, progress, settings }) =>
  scoreOf(lab, end, { evaluations: progress.evaluations, isAdaptive: settings.sampling === 'adaptive' });

/**
 * The largest hole, with the particle next to it, and the closest pair.
 * @param {LessonParticles} particles @param {Measures['places']} places
 */
export function placesOf({ positions, normals, radii }, { holes, pairs }) {
  const beside = holes[0] ? (nearest(positions, radii.length, holes[0].position)?.index ?? -1) : -1;
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

/** A figure of a score, formatted. @param {keyof ScoreFigures} key @param {Score} score */
export const written = (key, score) => (score[key] === null ? MISSING : rowOf(key).write(Number(score[key])));

/**
 * How much a figure varies among scores.
 * @param {keyof ScoreFigures} key
 * @param {readonly Score[]} scores
 */
export function widthOf(key, scores) {
  const values = scores.map((score) => Number(score[key]));
  return Math.max(...values) - Math.min(...values);
}

/** The figures of a score by name, as numbers. @param {Score} score */
export const namedFigures = (score) => Object.fromEntries(ROWS.map(({ key, name }) => [name, score[key]]));

/**
 * The chance of a figure for two scores, rounded as shown; null if the figure is not judged.
 * @param {ScoreRow} row @param {readonly Score[]} scores
 */
export const chanceOf = ({ chance, digits }, scores) =>
  chance ? rounded(Math.max(...scores.map(chance)), digits) : null;

/** @param {number} value @param {number} digits */
const rounded = (value, digits) => Number(value.toFixed(digits));

/**
 * Which of two scores has the better figure; −1 if the difference, as shown, may be chance.
 * @param {readonly Score[]} scores @param {ScoreRow} row
 */
export function bestOf(scores, row) {
  const chance = chanceOf(row, scores);
  const values = scores.map((score) => score[row.key]);
  if (chance === null || values.includes(null)) return -1;
  const [one, other] = values.map((value) => rounded(Number(value), row.digits));
  if (rounded(Math.abs(one - other), row.digits) <= chance) return -1;
  return one < other === (row.worse === 'above') ? 0 : 1;
}

/**
 * The figures that decide which sampling is better: the first one that differs by more than chance.
 */
export const DECIDING = /** @type {const} */ (['six', 'hole', 'pair']);

/**
 * Which of two scores is better, and by which figure; null if they cannot be distinguished.
 * @param {readonly Score[]} scores @param {readonly (keyof ScoreFigures)[]} [keys]
 */
export function verdictOf(scores, keys = DECIDING) {
  const key = keys.find((one) => bestOf(scores, rowOf(one)) >= 0);
  return key === undefined ? null : { key, side: bestOf(scores, rowOf(key)) };
}
