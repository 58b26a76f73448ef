/** Finds out what surface it is that goes straight along an axis: its formula does without that coordinate. */
import { dot, triple } from '../../engine/vector.js';

/** @import { Columns } from '../../engine/types.js' */

/** More directions than these are those of a curved surface. */
const MOST_PLANES = 8;
/** Cosine of normals that are those of one plane: particles lie on the surface to single precision. */
const PARALLEL = 0.999999;

/**
 * A plane, planes or a cylinder, by the particles.
 * @param {Pick<Columns, 'positions' | 'normals' | 'radii' | 'count'>} columns
 */
export function kindOf({ positions, normals, radii, count }) {
  /** Normals that differ, and how far from the origin the first plane of each is. @type {[number[], number][]} */
  const found = [];
  let isOne = true;
  for (let i = 0; i < count; i += 1) {
    const normal = triple(normals, i);
    const old = found.find(([one]) => Math.abs(dot(one, normal)) > PARALLEL);
    if (old) isOne &&= Math.abs(dot(old[0], triple(positions, i)) - old[1]) < radii[i];
    else found.push([normal, dot(normal, triple(positions, i))]);
    if (found.length > MOST_PLANES) return 'a cylinder';
  }
  return isOne && found.length === 1 ? 'a plane' : 'planes';
}
