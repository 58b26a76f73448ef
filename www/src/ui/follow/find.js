/**
 * Finds the particle that stands for another one: of a run for one of the picture, and of a new picture for an old
 * place.
 */
import { NO_PARENT } from '../../engine/core-numbers.js';

/**
 * Returns the particle nearest to a place, and its distance; null if there is none.
 * @param {ArrayLike<number>} positions  three per particle
 * @param {number} count
 * @param {ArrayLike<number>} place
 */
export function nearest(positions, count, place) {
  let particle = -1;
  let leastSq = Infinity;
  for (let i = 0; i < count; i += 1) {
    const sq = distanceSq(positions, i, place);
    if (sq < leastSq) [particle, leastSq] = [i, sq];
  }
  return particle < 0 ? null : { particle, distance: Math.sqrt(leastSq) };
}

/**
 * Returns the particle of a run that stands for a particle of the picture: the one with its number if it lies within r
 * of it, since every other one is about 2r away; else the nearest.
 * @param {ArrayLike<number>} positions  of the run, three per particle
 * @param {{ index: number, place: ArrayLike<number> }} wanted  of the picture
 * @param {number} radius
 */
export function standIn(positions, { index, place }, radius) {
  const count = positions.length / 3;
  if (index < count) {
    const distance = Math.sqrt(distanceSq(positions, index, place));
    if (distance < radius) return { particle: index, distance };
  }
  return nearest(positions, count, place);
}

/** @param {ArrayLike<number>} positions @param {number} i @param {ArrayLike<number>} place */
export function distanceSq(positions, i, place) {
  let sum = 0;
  for (let k = 0; k < 3; k += 1) sum += (positions[3 * i + k] - place[k]) ** 2;
  return sum;
}

/**
 * Returns the number of particles that are there when a particle is taken from the queue: they come in the order of
 * their parents, and a seed when the queue is empty.
 * @param {ArrayLike<number>} parents @param {number} particle
 */
export function placedBefore(parents, particle) {
  let [low, high] = [particle + 1, parents.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    const isLater = parents[middle] === NO_PARENT || parents[middle] >= particle;
    if (isLater) high = middle;
    else low = middle + 1;
  }
  return Math.min(low, parents.length);
}
