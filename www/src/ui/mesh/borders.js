/** Shows the open borders of a mesh in the picture. */
import { triple } from '../../engine/vector.js';
import { formatCount, plural } from '../format.js';

/** @import { Columns, MeshAnswer, Place, Vec3 } from '../../engine/types.js' */

/**
 * Returns what the picture shows of an open border: its outline, seen from the side that its particles face.
 * @param {MeshAnswer} mesh
 * @param {number} index
 * @param {Columns} columns
 * @returns {Place}
 */
export function borderOf({ loops }, index, { positions, normals }) {
  const rows = loops[index];
  const places = rows.map((i) => triple(positions, i));
  const mean = (/** @type {Vec3[]} */ of) =>
    /** @type {Vec3} */ ([0, 1, 2].map((k) => of.reduce((sum, v) => sum + v[k], 0) / of.length));
  const centre = mean(places);
  const count = loops.length > 1 ? ` · border ${formatCount(index + 1)} of ${formatCount(loops.length)}` : '';
  return {
    places,
    outline: true,
    radius: Math.max(...places.map((p) => Math.hypot(...p.map((v, k) => v - centre[k])))),
    normal: mean(rows.map((i) => triple(normals, i))),
    text: `${plural(rows.length, 'open edge')}${count}`,
  };
}
