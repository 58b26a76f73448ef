/**
 * The extents of the scene: the clip boxes and the balls to which the camera is fitted.
 *
 * @module
 */
import { ballOf } from './camera.js';

/** @import { Bounds, Columns, Vec3 } from '../types.js' */

/**
 * Radius of the ball in which a surface probably lies, as a share of the ball around the box. Surfaces seldom reach the
 * corners of their box.
 */
const LIKELY_SHARE = 0.72;

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const least = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.min(a[2], b[2])];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const most = (a, b) => [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.max(a[2], b[2])];

export class Scene {
  constructor() {
    /** The clip box of the requested field. @type {Bounds} */
    this.bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
    /** The clip box of the particles on the page. */
    this.shown = this.bounds;
  }

  /** Returns the ball around both clip boxes, since the surface on the page may belong to an earlier box. */
  ball() {
    const { bounds, shown } = this;
    return ballOf({ min: least(bounds.min, shown.min), max: most(bounds.max, shown.max) });
  }

  /**
   * Returns the ball to show before there are particles; if the box is drawn, it encloses the whole clip box.
   * @param {boolean} boxDrawn
   */
  boxBall(boxDrawn) {
    const { centre, radius } = ballOf(this.bounds);
    return { centre, radius: boxDrawn ? radius : radius * LIKELY_SHARE };
  }

  /**
   * Returns the ball for a fit: around the particles, or around the clip box without particles. If the particles belong
   * to an earlier field, a drawn clip box is included.
   * @param {Columns} columns
   * @param {boolean} boxDrawn  the ball encloses the clip box
   * @param {boolean} [axesDrawn]  the ball encloses the axes around the particles
   * @param {(particle: number) => boolean} [isShown]  the particles that are drawn; by default all
   */
  fitBall(columns, boxDrawn, axesDrawn = false, isShown = undefined) {
    const front = isShown && frontBall(columns, isShown);
    if (front) return front;
    const bounds = columns.bounds();
    if (!bounds || (boxDrawn && !columns.stale)) return this.boxBall(boxDrawn);
    if (boxDrawn) return ballOf({ min: least(bounds.min, this.bounds.min), max: most(bounds.max, this.bounds.max) });
    return axesDrawn ? ballOf(bounds) : ballAround(columns, ballOf(bounds).centre);
  }
}

/** Least radius around a visible front, in radii of its first particle: a lone seed would fill the picture. */
const LEAST_FRONT = 9;

/**
 * Returns the ball around the visible discs; null without any.
 * @param {Columns} columns @param {(particle: number) => boolean} isShown
 */
function frontBall({ placed, radii, count }, isShown) {
  const [min, max] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  let first = -1;
  for (let i = 0; i < count; i += 1) {
    if (!isShown(i)) continue;
    if (first < 0) first = i;
    for (let k = 0; k < 3; k += 1) {
      min[k] = Math.min(min[k], placed[3 * i + k] - radii[i]);
      max[k] = Math.max(max[k], placed[3 * i + k] + radii[i]);
    }
  }
  if (first < 0) return null;
  const { centre } = ballOf({ min, max });
  const { radius } = ballAround({ positions: placed, radii, count }, centre, isShown);
  return { centre, radius: Math.max(radius, LEAST_FRONT * radii[first]) };
}

/**
 * Returns the smallest ball with this centre that encloses the discs of all particles, or of some.
 * @param {{positions: ArrayLike<number>, radii: ArrayLike<number>, count: number}} columns
 * @param {Vec3} centre
 * @param {(particle: number) => boolean} [isShown]
 */
function ballAround({ positions, radii, count }, centre, isShown = () => true) {
  const [cx, cy, cz] = centre;
  // Above 0 even without particles, but smaller than the particles of the smallest box.
  let radius = 1e-30;
  for (let i = 0; i < count; i += 1) {
    if (!isShown(i)) continue;
    const [x, y, z] = [positions[3 * i] - cx, positions[3 * i + 1] - cy, positions[3 * i + 2] - cz];
    radius = Math.max(radius, Math.hypot(x, y, z) + radii[i]);
  }
  return { centre, radius };
}
