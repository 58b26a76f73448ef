/**
 * Where the things in the picture are: the clip boxes and the balls that the camera is fitted to.
 *
 * @module
 */
import { ballOf } from './camera.js';

/**
 * @typedef {import('../columns.js').Columns} Columns
 * @typedef {import('../types.js').Bounds} Bounds
 * @typedef {import('../types.js').Vec3} Vec3
 */

/** A surface seldom reaches the corners of its box: the ball through the middles of the edges is the better guess. */
const LIKELY_SHARE = 0.72;

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const least = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.min(a[2], b[2])];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const most = (a, b) => [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.max(a[2], b[2])];

export class Scene {
  constructor() {
    /** The clip box of the field asked for. @type {Bounds} */
    this.bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
    /** That of the particles on the page. */
    this.shown = this.bounds;
  }

  /** The ball around everything: the surface on the page may be that of another box than the one asked for. */
  ball() {
    const { bounds, shown } = this;
    return ballOf({ min: least(bounds.min, shown.min), max: most(bounds.max, shown.max) });
  }

  /** The ball to be seen before there are particles: of the whole clip box where it is drawn. @param {boolean} boxDrawn */
  boxBall(boxDrawn) {
    const { centre, radius } = ballOf(this.bounds);
    return { centre, radius: boxDrawn ? radius : radius * LIKELY_SHARE };
  }

  /** What a fit shows: the particles of the present field, else its clip box. @param {Columns} columns @param {boolean} boxDrawn */
  fitBall(columns, boxDrawn) {
    const bounds = columns.stale ? null : columns.bounds();
    return bounds ? ballAround(columns, ballOf(bounds).centre) : this.boxBall(boxDrawn);
  }
}

/** The smallest ball around this centre that holds all particles with their discs. @param {Columns} columns @param {Vec3} centre */
function ballAround({ positions, radii, count }, centre) {
  let radius = 1e-6;
  for (let i = 0; i < count; i += 1) {
    const [x, y, z] = [0, 1, 2].map((k) => positions[3 * i + k] - centre[k]);
    radius = Math.max(radius, Math.hypot(x, y, z) + radii[i]);
  }
  return { centre, radius };
}
