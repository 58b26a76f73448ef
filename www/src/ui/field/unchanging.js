/** Classifies a surface that is straight along an axis, since its formula does not contain that coordinate. */
import { dot, triple } from '../../engine/vector.js';

/** @import { Columns } from '../../engine/types.js' */

/** Largest number of directions of normals for planes; more mean a curved surface. */
const MOST_PLANES = 8;
/** Cosine above which normals count as parallel: positions are in single precision. */
const PARALLEL = 0.999999;

/**
 * Returns from the particles whether the surface is a plane, planes or a cylinder.
 * @param {Pick<Columns, 'positions' | 'normals' | 'radii' | 'count'>} columns
 */
export function kindOf({ positions, normals, radii, count }) {
  /** Distinct normals, each with the distance of its first plane from the origin. @type {[number[], number][]} */
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
