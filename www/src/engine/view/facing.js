/**
 * Computes the camera angles from which a point or much of the surface is visible.
 *
 * @module
 */

import { clamp } from '../vector.js';
import { axes } from './camera.js';

/** @import { Angles } from '../types.js' */

/** Yaws that are compared, over half a turn; the outline is the same from the opposite side. */
const YAWS = 12;
/** Cells along each side of the picture in which the outline is measured, and the most particles to be used. */
const CELLS = 24;
const MOST_SEEN = 20_000;
/** Another outline must be this many times larger to be worth a rotation. */
const WORTH_A_TURN = 1.1;

/**
 * Returns the yaw from which the outline of the particles is largest, or the current one if that is nearly as good.
 * @param {Angles} camera
 * @param {{positions: ArrayLike<number>, count: number}} particles
 * @param {import('./types.js').Ball} ball  around them
 */
export function widestYaw({ yaw, pitch }, { positions, count }, { centre, radius }) {
  const every = Math.max(1, Math.ceil(count / MOST_SEEN));
  const area = (/** @type {number} */ turned) => {
    const { right, up } = axes({ yaw: turned, pitch });
    const cells = new Uint8Array(CELLS * CELLS);
    for (let i = 0; i < count; i += every) {
      const [x, y, z] = [0, 1, 2].map((k) => (positions[3 * i + k] - centre[k]) / radius);
      const [across, high] = [right, up].map((axis) => axis[0] * x + axis[1] * y + axis[2] * z);
      cells[Math.floor((0.499 * high + 0.5) * CELLS) * CELLS + Math.floor((0.499 * across + 0.5) * CELLS)] = 1;
    }
    return cells.reduce((sum, cell) => sum + cell, 0);
  };
  let best = { yaw, area: WORTH_A_TURN * area(yaw) };
  for (let k = 1; k < YAWS; k += 1) {
    // The nearest yaws first, on alternate sides.
    const turned = yaw + ((k % 2 ? 1 : -1) * Math.ceil(k / 2) * Math.PI) / YAWS;
    const seen = area(turned);
    if (seen > best.area) best = { yaw: turned, area: seen };
  }
  return best.yaw;
}

/** Cosine of the angle to the normal below which a point counts as hidden. */
const FACING = 0.3;
/** Largest pitch; from straight above or below the up direction would be unclear. */
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
 * @param {number} [yaw]  the current one: the rotation takes the shorter way, and none from straight above
 * @returns {Angles}
 */
export function anglesOf([x, y, z], yaw = 0) {
  const way = Math.hypot(x, y) > 1e-3 ? Math.atan2(y, x) - yaw : 0;
  return {
    yaw: yaw + Math.atan2(Math.sin(way), Math.cos(way)),
    pitch: clamp(Math.asin(clamp(z, -1, 1)), -STEEPEST_RAD, STEEPEST_RAD),
  };
}
