/** Finds the front for the camera. */

import { along, dot, size, triple, unit } from '../engine/vector.js';
import { axes } from '../engine/view/camera.js';
import { anglesOf } from '../engine/view/facing.js';

/**
 * @import { LessonParticles } from '../engine/types.js'
 */

/** Levels around the seed whose discs the first view shows. */
export const FIRST_LEVELS = 5;
/** This many directions are 5° apart. */
const DIRECTIONS = 1500;

/**
 * The particles of the first front on some levels.
 * @param {LessonParticles} particles @param {number} from @param {number} to
 */
const onLevels = ({ levels, fronts }, from, to) =>
  [...levels.keys()].filter((i) => fronts[i] === 0 && levels[i] >= from && levels[i] <= to);

/** Directions spread evenly by a spiral. @type {readonly (readonly number[])[]} */
const AROUND = Array.from({ length: DIRECTIONS }, (_, k) => {
  const z = 1 - (2 * k + 1) / DIRECTIONS;
  const turn = k * Math.PI * (3 - Math.sqrt(5));
  const far = Math.sqrt(1 - z * z);
  return [far * Math.cos(turn), far * Math.sin(turn), z];
});

/**
 * The direction from which most discs on some levels of the first front are visible: their mean normal, unless another
 * direction is better.
 * @param {LessonParticles} particles @param {number} [from] @param {number} [to]
 * @returns {readonly number[]}
 */
export function frontNormal(particles, from = 0, to = FIRST_LEVELS) {
  const chosen = onLevels(particles, from, to);
  const sum = chosen.reduce((total, i) => along(total, triple(particles.normals, i), 1), [0, 0, 0]);
  const mean = size(sum) > 0 ? unit(sum) : AROUND[0];
  // The camera never looks from straight above or below.
  const seen = (/** @type {readonly number[]} */ way) => facingOf(particles, axes(anglesOf(way)).forward, chosen);
  const first = { way: mean, count: seen(mean) };
  if (first.count === chosen.length) return mean;
  return AROUND.reduce((best, way) => {
    const count = seen(way);
    return count > best.count ? { way, count } : best;
  }, first).way;
}

/**
 * How many of some discs face the eye.
 * @param {LessonParticles} particles @param {readonly number[]} forward  direction of the view
 * @param {readonly number[]} chosen
 */
const facingOf = ({ normals }, forward, chosen) => chosen.filter((i) => dot(forward, triple(normals, i)) < 0).length;

/**
 * The share of the discs on some levels of the first front that face the eye; 1 without discs.
 * @param {LessonParticles} particles @param {readonly number[]} forward  direction of the view
 * @param {number} from @param {number} to
 */
export function shareFacing(particles, forward, from, to) {
  const all = onLevels(particles, from, to);
  return all.length > 0 ? facingOf(particles, forward, all) / all.length : 1;
}
