/** Draws a relaxation step of one particle: the pushes on it and their sum, and the move enlarged. */

import { dot } from '../engine/vector.js';
import { s } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { inPlane, scaledBy, tangentsOf } from './geometry.js';
import { pushWords } from './rest.js';
import { label, line, ring } from './svg.js';

/** @import { Plane, Point, Rest, Subject } from './types.js' */

/** Half size of the drawing, in radii: particles push each other up to 3r. */
const HALF = 4.1;
/** Forces are drawn enlarged by this factor: a neighbour at 2r pushes by only a quarter of r. */
const FORCE_SCALE = 5;
/** Length of an arrow's head, in radii, and its half width over that. */
const HEAD = 0.22;
const HEAD_WIDTH = 0.5;
/** Half size of the enlargement, over the longer of the move and the way to the landing. */
const LENS_ROOM = 1.5;
/**
 * Enlargement by a lens whose half size is one radius, relative to the drawing: the lens shows 2r on 7.5 rem, the
 * drawing its whole width on 16.25 rem.
 */
const LENS_SCALE = 7.5 / 2 / (16.25 / (2 * HALF));
/** Below this share of r there is no move to enlarge. */
const LEAST_MOVE = 1e-6;

/** An arrow from the middle of the drawing. @param {string} kind @param {Point} to */
function arrow(kind, to) {
  const [x, y] = to;
  const length = Math.hypot(x, y);
  const head = Math.min(HEAD, 0.6 * length);
  const [u, v] = length > 0 ? [x / length, y / length] : [0, 0];
  /** @param {1 | -1} by @returns {Point} */
  const side = (by) => [x - head * (u - by * HEAD_WIDTH * v), y - head * (v + by * HEAD_WIDTH * u)];
  return line(kind, [[0, 0], to, side(1), to, side(-1)]);
}

/** A vector in the plane, in radii. @param {Plane} plane @param {ArrayLike<number>} v @returns {Point} */
const along = ({ right, up, radius }, v) => [dot(v, right) / radius, dot(v, up) / radius];

/** @param {Rest} rest @param {ArrayLike<number>} [towards]  where the drawing's right is @returns {Plane} */
function planeOf({ place, normal, radius }, towards) {
  const [right, up] = tangentsOf(normal, towards);
  return { centre: place, right, up, radius };
}

/**
 * Draws the particles that push, their pushes, and the sum.
 * @param {Subject} subject @param {Rest} rest @param {ArrayLike<number>} [towards]
 */
export function restPlane({ particle }, rest, towards) {
  const plane = planeOf(rest, towards);
  const svg = s('svg', {
    class: 'drawing rest',
    viewBox: `${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`,
    role: 'img',
    'aria-label': `Tangent plane of particle ${formatCount(particle)} in relaxation step ${rest.step}: ${pushWords(rest)}`,
  });
  const scaled = (/** @type {ArrayLike<number>} */ force) => scaledBy(along(plane, force), FORCE_SCALE);
  for (const { at, radius } of rest.pushes) svg.append(ring('disc', inPlane(plane, at), radius / rest.radius));
  svg.append(ring('self', [0, 0], 1));
  for (const { particle: other, at } of rest.pushes)
    svg.append(label('number', inPlane(plane, at), formatCount(other)));
  for (const { force } of rest.pushes) svg.append(arrow('push', scaled(force)));
  svg.append(arrow('sum', scaled(rest.moved.force)));
  return svg;
}

/**
 * The move and the landing enlarged, with how many times that is; null if there is no move to see.
 * @param {Rest} rest
 * @param {ArrayLike<number>} [towards]
 */
export function moveLens(rest, towards) {
  const plane = planeOf(rest, towards);
  const [target, landing] = [rest.moved.target, rest.moved.position].map((at) => inPlane(plane, at));
  const far = Math.max(Math.hypot(...target), Math.hypot(...landing));
  if (!(far > LEAST_MOVE)) return null;
  const half = LENS_ROOM * far;
  const at = (point = target) => scaledBy(point, 1 / half);
  const svg = s(
    'svg',
    { class: 'drawing lens rest', viewBox: '-1 -1 2 2', 'aria-hidden': 'true' },
    ring('point', [0, 0], 0.06),
    arrow('sum', at(target)),
    ring('landed', at(landing), 0.09),
  );
  return { svg, times: LENS_SCALE / half };
}

/** The scale of the drawing, in words. */
export const SCALE_WORDS = `Thin arrows: the pushes. The strong one: their sum in the tangent plane. All are drawn ${FORCE_SCALE} times as long.`;
