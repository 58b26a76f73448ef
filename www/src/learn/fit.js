/** The distance of the eye at which bodies fill a picture, from any side. */
import { FIELD_OF_VIEW_RAD } from '../engine/view/camera.js';

/**
 * @import { Vec3 } from '../engine/types.js'
 * @import { Ball } from '../engine/view/types.js'
 * @import { Discs } from './types.js'
 */

/** Room around the bodies, as a share of their extent. */
const MARGIN = 1.04;

/**
 * The room that bodies need in a picture with parallel rays while they turn about the vertical. It depends only on the
 * pitch, so that a body keeps its size as it turns.
 */
export class Fit {
  /**
   * For each disc its distance from the axis, its height above the middle, and its radius.
   * @type {[number, number, number][]}
   */
  #discs;
  /** A ball around all. @type {Ball} */
  #ball;

  /** @param {readonly Discs[]} bodies  with at least one disc in all */
  constructor(bodies) {
    const min = [Infinity, Infinity, Infinity];
    const max = [-Infinity, -Infinity, -Infinity];
    for (const { positions } of bodies) {
      for (let i = 0; i < positions.length; i += 1) {
        min[i % 3] = Math.min(min[i % 3], positions[i]);
        max[i % 3] = Math.max(max[i % 3], positions[i]);
      }
    }
    const centre = /** @type {Vec3} */ (min.map((low, k) => (low + max[k]) / 2));
    this.#discs = bodies.flatMap(({ positions, radii }) =>
      Array.from(radii, (radius, i) => {
        const [x, y, z] = centre.map((c, k) => positions[3 * i + k] - c);
        return /** @type {[number, number, number]} */ ([Math.hypot(x, y), Math.abs(z), radius]);
      }),
    );
    const radius = Math.max(...this.#discs.map(([far, high, own]) => Math.hypot(far, high) + own));
    this.#ball = { centre, radius };
  }

  /**
   * The ball around the bodies, and the distance at which they fill a picture.
   * @param {number} pitch @param {{ width: number, height: number }} size
   */
  in(pitch, { width, height }) {
    const [up, across] = [Math.abs(Math.cos(pitch)), Math.abs(Math.sin(pitch))];
    let [wide, high] = [0, 0];
    for (const [far, along, radius] of this.#discs) {
      wide = Math.max(wide, far + radius);
      high = Math.max(high, along * up + far * across + radius);
    }
    const shorter = Math.min(width, height);
    const half = Math.max((wide * shorter) / width, (high * shorter) / height);
    return { ball: this.#ball, distance: (MARGIN * half) / Math.tan(FIELD_OF_VIEW_RAD / 2) };
  }
}
