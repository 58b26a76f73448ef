/** A patch of a sampling, unrolled into a plane: its cells, and the places of the three figures. */
import { cross, distance, triple, unit } from '../engine/vector.js';
import { unrolled } from '../figures/geometry.js';

/** @import { Point } from '../figures/types.js' */
/** @import { LabRun, Score } from './types.js' */

/**
 * Half the width and half the height of a patch in r, and the margin in which particles are included.
 */
export const HALF = { width: 5, height: 4 };
const BEYOND = 4;

/**
 * The corners of a point's Voronoi cell: everything nearer to it than to any of the others.
 * @param {Point} place @param {readonly Point[]} others @param {number} reach  of the corners, along each axis
 */
export function cellOf(place, others, reach) {
  const [x, y] = place;
  /** @type {Point[]} */
  let corners = [
    [x - reach, y - reach],
    [x + reach, y - reach],
    [x + reach, y + reach],
    [x - reach, y + reach],
  ];
  for (const other of others) {
    const [dx, dy] = [other[0] - x, other[1] - y];
    const limit = (dx * dx + dy * dy) / 2;
    if (limit === 0) continue;
    const beyond = (/** @type {Point} */ corner) => (corner[0] - x) * dx + (corner[1] - y) * dy - limit;
    corners = corners.flatMap((from, k) => {
      const to = corners[(k + 1) % corners.length];
      const [a, b] = [beyond(from), beyond(to)];
      const share = a / (a - b);
      /** @type {Point} */
      const cut = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
      if (a <= 0) return b > 0 ? [from, cut] : [from];
      return b < 0 ? [cut] : [];
    });
  }
  return corners;
}

/**
 * The patch around the largest hole of a run: its particles with cells and neighbours, the hole, and the closest pair
 * in the patch. Null if no hole is measured. Lengths are in r.
 * @param {LabRun} run @param {Score} score  at its end
 */
export function patchOf({ end, radius }, { places: { hole }, valence }) {
  if (!hole) return null;
  const { positions } = end;
  const [centre] = hole.places;
  const right = unit(cross(Math.abs(hole.normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], hole.normal));
  const plane = { centre, right, up: cross(hole.normal, right), radius };
  const near = [...end.radii.keys()]
    .filter((i) => distance(triple(positions, i), centre) < radius * (Math.hypot(HALF.width, HALF.height) + BEYOND))
    .map((i) => ({ particle: i, at: unrolled(plane, triple(positions, i)), valence: valence[i] }));
  const all = near.map(({ at }) => at);
  const seen = near
    .filter(({ at: [x, y] }) => Math.abs(x) < HALF.width + 1 && Math.abs(y) < HALF.height + 1)
    .map((one) => ({ ...one, cell: cellOf(one.at, all, BEYOND) }));
  const inside = seen.filter(({ at: [x, y] }) => Math.abs(x) < HALF.width - 1 && Math.abs(y) < HALF.height - 1);
  const pairs = inside.flatMap((one, k) => inside.slice(k + 1).map((other) => /** @type {const} */ ([one, other])));
  const far = (/** @type {(typeof pairs)[number]} */ [one, other]) =>
    distance(triple(positions, one.particle), triple(positions, other.particle));
  const pair = pairs.reduce((best, other) => (far(other) < far(best) ? other : best), pairs[0]);
  return { seen, hole: hole.radius / radius, pair: pair?.map(({ at }) => at) ?? [] };
}
