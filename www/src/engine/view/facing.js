/**
 * Computes the camera angles from which a point of the surface is visible.
 *
 * @module
 */

import { clamp } from '../vector.js';

/** @import { Angles } from '../types.js' */

/** Cosine of the angle to the normal below which a point counts as hidden. */
const FACING = 0.3;
/** Largest pitch. From straight above or below, the up direction would be unclear. */
const STEEPEST_RAD = 0.9;

/**
 * Returns the camera angles that face a normal, or null if the camera already faces it.
 * @param {Angles} camera
 * @param {Iterable<number>} normal  of length 1
 */
export function facing({ yaw, pitch }, [x, y, z]) {
  const seen = x * Math.cos(yaw) * Math.cos(pitch) + y * Math.sin(yaw) * Math.cos(pitch) + z * Math.sin(pitch);
  return seen < FACING ? anglesOf([x, y, z], yaw) : null;
}

/**
 * Returns the camera angles that face a normal.
 * @param {Iterable<number>} normal  of length 1
 * @param {number} [yaw]  present one: the rotation takes the shorter way, and from straight above none
 * @returns {Angles}
 */
export function anglesOf([x, y, z], yaw = 0) {
  const way = Math.hypot(x, y) > 1e-3 ? Math.atan2(y, x) - yaw : 0;
  return {
    yaw: yaw + Math.atan2(Math.sin(way), Math.cos(way)),
    pitch: clamp(Math.asin(clamp(z, -1, 1)), -STEEPEST_RAD, STEEPEST_RAD),
  };
}
