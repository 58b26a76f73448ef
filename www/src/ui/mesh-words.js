/** Says what a mesh adds up to: whether it is closed, its topology, volume and worst angle. */

import { formatCount, formatFixed, formatSignificant, plural } from './format.js';

/** @import { MeshAnswer } from '../engine/types.js' */

/**
 * What is said of the sign of f inside of the closed parts.
 * @type {Record<NonNullable<MeshAnswer['inside']>, string>}
 */
const TURNED = {
  'f < 0': '',
  'f > 0': 'f is larger inside; files face outward',
  'f < 0, f > 0': 'f is larger inside some parts; files face outward',
};

/** Most components whose Euler numbers are told one by one. */
const MOST_TOLD = 3;

/**
 * Returns the verdict on a mesh in one line. All of it is counted on the triangles themselves, those at borders among
 * them, which are those of the file.
 * @param {MeshAnswer} mesh
 */
export function verdictOf({ components, unfilled, left_out, volume, inside, smallest_angle }) {
  if (components.length === 0) return 'Nothing to join to a mesh';
  const open = components.reduce((sum, component) => sum + component.open_edges, 0);
  const euler = components.map((component) => formatCount(component.euler));
  const sum = components.reduce((total, component) => total + component.euler, 0);
  return [
    open > 0 ? plural(open, 'open edge') : volume === null ? 'No open edge, but not a manifold' : 'Watertight',
    components.length > 1 ? plural(components.length, 'component') : '',
    components.length > MOST_TOLD
      ? `Euler numbers add up to ${formatCount(sum)}`
      : `Euler number${euler.length > 1 ? 's' : ''} ${euler.join(', ')}`,
    volume === null ? '' : `volume ${formatSignificant(volume, 4)}`,
    inside === null ? '' : TURNED[inside],
    smallest_angle === null ? '' : `smallest angle ${formatFixed(smallest_angle, 1)}°`,
    unfilled > 0 ? `${plural(unfilled, 'hole')} where sheets meet or particles are too sparse` : '',
    left_out > 0 ? `${plural(left_out, 'particle')} left out` : '',
  ]
    .filter(Boolean)
    .join(' · ');
}
