/** Places in a plane through a particle, in radii. */
import { dot } from '../engine/vector.js';

/** @import { Plane, Point } from './types.js' */

/**
 * Returns where a place is in the plane, projected along its normal, in radii.
 * @param {Plane} plane @param {ArrayLike<number>} place  @returns {Point}
 */
export function inPlane({ centre, right, up, radius }, place) {
  const way = [0, 1, 2].map((k) => place[k] - centre[k]);
  return [dot(way, right) / radius, dot(way, up) / radius];
}

/**
 * Place of a slot's child before its projection, in radii: 2 away at 60° times its number.
 * @param {number} slot
 * @returns {Point}
 */
export const slotPlace = (slot) => [2 * Math.cos((slot * Math.PI) / 3), 2 * Math.sin((slot * Math.PI) / 3)];

/** Least span of a lens, in radii; below it all points count as one. */
const LEAST_SPAN = 1e-6;
/** Room around what a lens shows, as a share of its span. */
const MARGIN = 0.3;

/**
 * Returns the square that shows all points enlarged; null if they coincide.
 * @param {readonly Point[]} points  @returns {{ centre: Point, half: number } | null}
 */
export function lensOf(points) {
  const [x0, x1, y0, y1] = [
    Math.min(...points.map(([x]) => x)),
    Math.max(...points.map(([x]) => x)),
    Math.min(...points.map(([, y]) => y)),
    Math.max(...points.map(([, y]) => y)),
  ];
  const span = Math.max(x1 - x0, y1 - y0);
  if (!(span > LEAST_SPAN) || !Number.isFinite(span)) return null;
  return { centre: [(x0 + x1) / 2, (y0 + y1) / 2], half: (0.5 + MARGIN) * span };
}

/** Angle between neighbouring points of an arc, in radians. */
const CORNER_RAD = Math.PI / 48;

/**
 * Returns a place in the plane at its true distance from the particle, which the algorithm uses.
 * @param {Plane} plane @param {ArrayLike<number>} place @returns {Point}
 */
export function unrolled(plane, place) {
  const [x, y] = inPlane(plane, place);
  const flat = Math.hypot(x, y);
  const way = [0, 1, 2].map((k) => place[k] - plane.centre[k]);
  const scale = flat > 0 ? Math.hypot(way[0], way[1], way[2]) / plane.radius / flat : 1;
  return [scale * x, scale * y];
}

/**
 * Returns points of an arc, counter-clockwise.
 * @param {number} from  in radians @param {number} width @param {number} at  its radius @returns {Point[]}
 */
export function arcOf(from, width, at) {
  const corners = Math.max(2, Math.ceil(Math.abs(width) / CORNER_RAD));
  return Array.from({ length: corners + 1 }, (_, k) => {
    const angle = from + (width * k) / corners;
    return [at * Math.cos(angle), at * Math.sin(angle)];
  });
}

/** The width of a free space. @param {readonly [number, number]} angles */
export function widthOf([from, to]) {
  const width = to - from;
  return width > 0 ? width : width + 2 * Math.PI;
}

/** @param {Point} p @param {number} factor @returns {Point} */
export const scaledBy = ([x, y], factor) => [x * factor, y * factor];
/** @param {number} angle @param {number} distance @returns {Point} */
export const polar = (angle, distance) => [distance * Math.cos(angle), distance * Math.sin(angle)];
