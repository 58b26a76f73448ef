/**
 * The choices of *What if*, of which several can be changed at once. Their values are joined to one word, such as
 * `stack~0.4~0~0`, for addresses and assignments.
 */
import { formatFixed } from '../ui/format.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { Knob, Setup, Side } from './types.js'
 */

/** Separates the values. */
const BETWEEN = '~';

/** @param {string} value */
export const partsOf = (value) => value.split(BETWEEN);

/** The value with one of the choices changed. @param {string} value @param {number} k @param {string} part */
export const turned = (value, k, part) => partsOf(value).with(k, part).join(BETWEEN);

/** Range of the tolerance, in 2r. */
export const TOLERANCES = { min: 0.4, max: 0.95, step: 0.05 };

/** A tolerance in words, in radii like every length of the lesson. @param {number} of2r */
export const toleranceWords = (of2r) => `${formatFixed(2 * of2r, 1)} r`;

/** The value of a pressed seed begins with this, followed by its coordinates. */
const AT = 'at ';

/** @param {readonly number[]} place */
export const seedAt = (place) => AT + place.map((v) => Number(v.toPrecision(4))).join(' ');

/** @param {string} value @returns {[number, number, number]} */
function parsePlace(value) {
  const [x, y, z] = value.slice(AT.length).split(' ').map(Number);
  return [x, y, z];
}

/** @param {string} value */
const isPlace = (value) => value.startsWith(AT) && parsePlace(value).every(Number.isFinite);

/** @param {Record<string, string>} labels  by their values */
const values = (labels) => Object.entries(labels).map(([value, label]) => ({ value, label }));

/** @type {readonly Knob[]} */
export const KNOBS = [
  {
    name: 'Who comes next',
    values: values({ queue: 'Queue', stack: 'Stack' }),
    set: (order) => ({ order: /** @type {LessonSettings['order']} */ (order) }),
    why: () =>
      'The newest particle comes next, so the front runs off like a thread. Threads meet far more often than rings do, and every meeting is a seam.',
  },
  {
    name: 'Tolerance',
    values: [],
    scale: TOLERANCES,
    set: (tolerance) => ({ match_tolerance: Number(tolerance) }),
    why: (part) =>
      Number(part) < 0.7
        ? 'Where rows meet, a particle that is off by more than this does not count as the child. A second one is put beside it, and the particles crowd. The ideal for so many is finer, so that a hole of the same width counts as larger.'
        : 'A child counts as matched by a particle far from its place. Nothing is put there, and the hole stays open.',
  },
  {
    name: 'Relaxation',
    values: values({ 10: 'Ten steps', 0: 'No steps', 100: 'A hundred steps' }),
    set: (steps) => ({ relax_steps: Number(steps) }),
    why: (part) =>
      part === '0'
        ? 'Nothing is pushed into the holes that placing leaves beside its seams.'
        : 'Pushed that long, particles go farther from where the front has put them.',
  },
  {
    name: 'Seed',
    values: values({ 0: 'Seed 0', 1: 'Seed 1', 2: 'Seed 2', 3: 'Seed 3' }),
    set: (seed) => (isPlace(seed) ? { seeds: [parsePlace(seed)] } : { seed: Number(seed) }),
    why: () => 'Another seed moves the rings, and the seams with them. Their number hardly changes.',
  },
];
/** Index of the tolerance, and of the seed, which may also be a place. */
export const [TOLERANCE, SEED] = [1, 3];

/** The choices of the lesson. */
export const USUAL = ['queue', '0.7', '10', '0'].join(BETWEEN);
/** What stands beside it at first. */
const OTHER = turned(USUAL, 0, 'stack');

/** A value of a choice in words. @param {number} k @param {string} part */
export const partWords = (k, part) =>
  KNOBS[k].scale ? toleranceWords(Number(part)) : (KNOBS[k].values.find(({ value }) => value === part)?.label ?? part);

/** @param {string} part @param {number} k */
function isPart(part, k) {
  const { scale, values: all } = KNOBS[k];
  if (scale) return Number(part) >= scale.min && Number(part) <= scale.max;
  return all.some(({ value }) => value === part) || (k === SEED && isPlace(part));
}

/** @param {readonly string[]} words */
const listed = ([first, ...others]) => [first, ...others.map((word) => word.toLowerCase())].join(', ');

/** All choices in words. @param {string} value */
export const knobWords = (value) => listed(partsOf(value).map((part, k) => partWords(k, part)));

/** The choices in which two samplings differ, in words for each; all of them if none does. @param {string[]} values */
export function knobDifference(...values) {
  const [left, right] = values.map(partsOf);
  const differ = left.flatMap((part, k) => (part === right[k] ? [] : [k]));
  if (differ.length === 0) return values.map(knobWords);
  return [left, right].map((parts) => listed(differ.map((k) => partWords(k, parts[k]))));
}

/** The sampling of a value. @param {string} value @returns {Side} */
export const knobSide = (value) => ({
  label: knobWords(value),
  make: (lab) => lab.run(Object.assign({}, ...partsOf(value).map((part, k) => KNOBS[k].set(part)))),
});

/** @param {unknown} value */
const isValue = (value) =>
  typeof value === 'string' && partsOf(value).length === KNOBS.length && partsOf(value).every(isPart);

/**
 * A comparison with the given values; what is missing or invalid is as at first.
 * @param {{ on?: unknown, left?: unknown, right?: unknown }} given
 * @returns {Setup}
 */
export const setupOf = ({ on, left, right }) => ({
  on: typeof on === 'string' ? on : '',
  left: isValue(left) ? String(left) : USUAL,
  right: isValue(right) ? String(right) : OTHER,
});
