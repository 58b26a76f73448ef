/** Says in one line what a mesh adds up to, and where it is open or leaves particles out. */
import { formatCount, formatSignificant, plural } from '../format.js';

/** @import { MeshAnswer } from '../../engine/types.js' */

/** Most components whose Euler numbers are told one by one. */
const MOST_TOLD = 3;

/** @param {MeshAnswer} mesh */
export function meshWords({ components, unfilled, left_out, volume }) {
  if (components.length === 0) return 'Nothing to join to a mesh';
  const open = components.reduce((sum, component) => sum + component.open_edges, 0);
  const euler = components.map((component) => formatCount(component.euler));
  const sum = components.reduce((total, component) => total + component.euler, 0);
  const kind = open === 0 ? 'closed' : plural(open, 'open edge');
  return [
    components.length === 1
      ? open === 0
        ? 'Closed mesh'
        : 'Mesh'
      : `Mesh of ${plural(components.length, 'component')}`,
    components.length === 1 && open === 0 ? '' : kind,
    components.length > MOST_TOLD
      ? `Euler numbers add up to ${formatCount(sum)}`
      : `Euler number${euler.length > 1 ? 's' : ''} ${euler.join(', ')}`,
    volume === null ? '' : `volume ${formatSignificant(volume, 4)}`,
    unfilled > 0 ? `${plural(unfilled, 'hole')} where sheets meet or particles are too sparse` : '',
    left_out > 0 ? `${plural(left_out, 'particle')} left out` : '',
  ]
    .filter(Boolean)
    .join(' · ');
}

/** The message where no mesh can be drawn. */
export const NO_MESH = 'A mesh needs WebGPU or WebGL2; the picture shows discs';
