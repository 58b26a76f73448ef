/** Numbers, and vectors of three of them. */

/** @import { Vec3 } from './types.js' */

/** @param {number} value @param {number} low @param {number} high */
export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** Returns the vector of f(0), f(1) and f(2). @param {(axis: number) => number} f @returns {Vec3} */
export const vec = (f) => [f(0), f(1), f(2)];
/** Returns vector number i of a column. @param {ArrayLike<number>} column @param {number} i @returns {Vec3} */
export const triple = (column, i) => [column[3 * i], column[3 * i + 1], column[3 * i + 2]];

/** @param {ArrayLike<number>} p @param {ArrayLike<number>} q */
export const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
/** @param {ArrayLike<number>} p @param {ArrayLike<number>} q @returns {Vec3} */
export const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
/** Returns p + t q. @param {ArrayLike<number>} p @param {ArrayLike<number>} q @param {number} t @returns {Vec3} */
export const along = (p, q, t) => [p[0] + t * q[0], p[1] + t * q[1], p[2] + t * q[2]];
/** @param {ArrayLike<number>} v */
export const size = (v) => Math.hypot(v[0], v[1], v[2]);
/** @param {ArrayLike<number>} p @param {ArrayLike<number>} q */
export const distance = (p, q) => size(along(p, q, -1));
/**
 * Returns the vector of a column that is nearest to a point, and its distance; null for an empty column.
 * @param {ArrayLike<number>} column @param {number} count @param {ArrayLike<number>} place
 */
export function nearest(column, count, place) {
  let best = { index: -1, distance: Infinity };
  for (let i = 0; i < count; i += 1) {
    const away = Math.hypot(column[3 * i] - place[0], column[3 * i + 1] - place[1], column[3 * i + 2] - place[2]);
    if (away < best.distance) best = { index: i, distance: away };
  }
  return best.index < 0 ? null : best;
}
/** Returns the vector with length 1; 0 stays 0. @param {ArrayLike<number>} v @returns {Vec3} */
export function unit(v) {
  const length = size(v) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}
