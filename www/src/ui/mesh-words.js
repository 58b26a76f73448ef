/** Describes a mesh: whether it is closed, its parts and its size, and the figures behind that. */

import { formatCount, formatFixed, formatSignificant, plural } from './format.js';
import { sidesOf } from './print.js';

/** @import { MeshAnswer } from '../engine/types.js' */

/**
 * Texts for the sign of f inside the closed parts.
 * @type {Record<NonNullable<MeshAnswer['inside']>, string>}
 */
const INSIDE = {
  'f < 0': 'f is smaller',
  'f > 0': 'f is larger; files face outward',
  'f < 0, f > 0': 'f is larger in some parts; files face outward',
};

/** Largest number of components whose Euler numbers are listed. */
const MOST_TOLD = 3;
/** Significant digits of a length: 0.1 mm for a part of 40 mm. */
const SIZE_DIGITS = 3;

/** Number of open edges of a mesh. @param {MeshAnswer} mesh */
const openEdgesOf = ({ components }) => components.reduce((sum, component) => sum + component.open_edges, 0);

/** Returns the parts in words. @param {MeshAnswer} mesh */
function partsOf({ bodies }) {
  const chips = bodies.filter((body) => body.is_chip).length;
  const parts = plural(bodies.length - chips, 'part');
  return chips > 0 ? `${parts} and ${plural(chips, 'loose chip')}` : parts;
}

/**
 * Returns the verdict on a mesh in one line. It counts the very triangles that the file contains, including those at
 * borders.
 * @param {MeshAnswer} mesh
 * @param {{ scale?: number, unit?: string }} [file]  length of a unit of the formula, and its unit, in a file
 */
export function verdictOf(mesh, { scale = 1, unit = '' } = {}) {
  const { components, bodies, unfilled, volume } = mesh;
  if (components.length === 0) return 'Nothing to join to a mesh';
  const open = openEdgesOf(mesh);
  const sides = sidesOf(bodies).map((side) => formatSignificant(scale * side, SIZE_DIGITS));
  return [
    open > 0 ? `Open: ${plural(open, 'open edge')}` : volume === null ? 'No open edge, but parts touch' : 'Closed',
    partsOf(mesh),
    `${sides.join('\u00a0×\u00a0')}${unit && `\u00a0${unit}`}`,
    unfilled > 0 ? `${plural(unfilled, 'hole')} where sheets meet or particles are too sparse` : '',
  ]
    .filter(Boolean)
    .join(' · ');
}

/**
 * Returns pairs of a name and a figure of a mesh.
 * @param {MeshAnswer} mesh
 * @param {{ scale?: number, unit?: string }} [file]
 * @returns {[string, string][]}
 */
export function figuresOf({ triangles, components, volume, inside, smallest_angle, left_out }, file = {}) {
  const { scale = 1, unit = '' } = file;
  const numbers = components.map(({ euler }) => euler);
  const sum = numbers.reduce((total, euler) => total + euler, 0);
  const many = components.length > MOST_TOLD;
  /** @type {[string, string | false][]} */
  const rows = [
    ['Triangles', formatCount(triangles)],
    ['Components', formatCount(components.length)],
    [
      many ? 'Sum of the Euler numbers' : components.length > 1 ? 'Euler numbers' : 'Euler number',
      many ? formatCount(sum) : numbers.map(formatCount).join(', '),
    ],
    ['Volume', volume !== null && `${formatSignificant(volume * scale ** 3, 4)}${unit && `\u00a0${unit}³`}`],
    ['Smallest angle', smallest_angle !== null && `${formatFixed(smallest_angle, 1)}°`],
    ['Inside', inside !== null && INSIDE[inside]],
    ['Particles left out', left_out > 0 && formatCount(left_out)],
  ];
  return rows.flatMap(([name, value]) => (value === false ? [] : [[name, value]]));
}
