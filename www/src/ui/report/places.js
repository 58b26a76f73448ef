/** Finds the places in the picture that a figure of the report is about: crowded pairs and wide holes. */

import { nearest, triple } from '../../engine/vector.js';
import { formatFixed } from '../format.js';
import { valueAt } from './rows.js';

/** @import { Columns, Place, Report } from '../../engine/types.js' */

/** @typedef {Report['places']['pairs'][number]} Pair */
/** @typedef {Report['places']['holes'][number]} Hole */

/**
 * Returns the list of places at a path of the report, the worst first.
 * @param {Report | null} report
 * @param {string | null} path
 * @returns {(Pair | Hole)[]}
 */
export function listOf(report, path) {
  const list = report && path ? valueAt(report, path) : null;
  return Array.isArray(list) ? list : [];
}

/**
 * Returns what the picture shows of one place in a list.
 * @param {(Pair | Hole)[]} list
 * @param {number} index
 * @param {Columns} columns
 * @returns {Place}
 */
export function placeOf(list, index, columns) {
  const place = list[index];
  const { positions, normals, radii } = columns;
  const count = list.length > 1 ? ` · ${index + 1} of ${list.length}` : '';
  if ('particles' in place) {
    const [i, j] = place.particles;
    return {
      places: [triple(positions, i), triple(positions, j)],
      radius: Math.max(radii[i], radii[j]),
      normal: triple(normals, i),
      text: formatFixed(place.ratio, 3) + count,
    };
  }
  return {
    places: [place.position],
    radius: place.radius,
    normal: triple(normals, nearest(positions, columns.count, place.position)?.index ?? 0),
    text: formatFixed(place.ratio, 2) + count,
  };
}
