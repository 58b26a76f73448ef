/**
 * Finds the particle that stands for another one: of a run for one of the picture, and of a new picture for an old
 * place.
 */
import { NO_PARENT } from '../../engine/core-numbers.js';
import { distance, nearest, triple } from '../../engine/vector.js';

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
    const away = distance(triple(positions, index), place);
    if (away < radius) return { index, distance: away };
  }
  return nearest(positions, count, place);
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
