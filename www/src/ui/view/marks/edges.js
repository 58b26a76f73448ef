/** Chooses edges of the clip box on the outline of its picture, so that figures do not cover the surface. */
import { dot } from '../../../engine/vector.js';
import { axisVector, centreOf, cornerOf } from '../../space.js';

/**
 * @import { Bounds, Engine } from '../../../engine/types.js'
 * @import { Edge, Point } from '../types.js'
 */

/**
 * Returns the edge along an axis for its figures: on the outline of the picture, the lowest for x and y, the leftmost
 * for z; null if the box reaches behind the eye.
 * @param {Engine} engine
 * @param {Bounds} bounds
 * @param {number} axis
 * @returns {Edge | null}
 */
export function outerEdge(engine, bounds, axis) {
  const centre = engine.project(centreOf(bounds));
  if (!centre) return null;
  const { eye } = engine.rayThrough(centre.x, centre.y);
  const [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
  // A face of the box is seen from outside if the eye is beyond its plane.
  const faces = (/** @type {number} */ k, /** @type {number} */ upper) =>
    upper ? dot(eye, axisVector(k)) > bounds.max[k] : dot(eye, axisVector(k)) < bounds.min[k];
  /** @type {(Edge & { outer: boolean, rank: number })[]} */
  const edges = [];
  for (const a of [0, 1]) {
    for (const b of [0, 1]) {
      const corner = (a << i) | (b << j);
      /** @type {[number[], number[]]} */
      const ends = [cornerOf(bounds, corner), cornerOf(bounds, corner | (1 << axis))];
      const [from, to] = ends.map((end) => engine.project(end));
      if (!from || !to) return null;
      const middle = { x: from.x + to.x, y: from.y + to.y };
      edges.push({
        from,
        to,
        ends,
        centre,
        outer: faces(i, a) !== faces(j, b),
        rank: axis === 2 ? -middle.x : middle.y,
      });
    }
  }
  // Seen from inside the box, no edge is on an outline.
  const outer = edges.filter((edge) => edge.outer);
  return (outer.length ? outer : edges).reduce((best, edge) => (edge.rank > best.rank ? edge : best));
}

/**
 * Returns the unit direction perpendicular to an edge, away from a point, and the anchor of a text placed there.
 * @param {{ from: Point, to: Point }} edge
 * @param {Point} centre
 * @returns {Point & { anchor: 'start' | 'middle' | 'end' }}
 */
export function outward({ from, to }, centre) {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const length = Math.hypot(dx, dy) || 1;
  let [x, y] = [-dy / length, dx / length];
  const side = ((from.x + to.x) / 2 - centre.x) * x + ((from.y + to.y) / 2 - centre.y) * y;
  if (side < 0) [x, y] = [-x, -y];
  return { x, y, anchor: x > 0.4 ? 'start' : x < -0.4 ? 'end' : 'middle' };
}
