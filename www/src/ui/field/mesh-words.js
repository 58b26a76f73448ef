/** Describes in words a triangle mesh that is remeshed, and the distance of the new mesh from it. */
import { formatCount, formatShare, formatSignificant, plural } from '../format.js';

/** @import { MeshChange, MeshInfo } from '../../engine/types.js' */

/** Describes the parts of a mesh. @param {MeshInfo} info */
export function facesOf({ faces, vertices, pieces, border_edges, fan_edges, scan }) {
  const parts = [
    `${plural(faces, 'face')} with ${plural(vertices, 'vertex', 'vertices')} in ${plural(pieces, 'piece')}.`,
  ];
  if (scan && border_edges > 0)
    parts.push(`Holes with ${plural(border_edges, 'edge')} at their borders are closed smoothly.`);
  if (scan && fan_edges > 0)
    parts.push(`${plural(fan_edges, 'edge')} with more than two faces: inside is where faces wind around.`);
  return parts.join(' ');
}

/** Says what was mended; empty if nothing was. @param {MeshInfo} info */
export const mendedOf = ({ mended }) => (mended.length > 0 ? `Mended: ${mended.join(', ')}.` : '');

/** Says what kind of object the mesh is treated as. @param {MeshInfo} info */
export function madeOf({ part, scan, union }) {
  if (part) {
    const ending = plural(part.faded, 'sharp edge that ends', 'sharp edges that end');
    const faded = part.faded > 0 ? ` ${ending} within a patch will be rounded.` : '';
    const { patches, edges, corners, rim } = part;
    const smoothed = rim?.is_smoothed ? ', which zigzags and was smoothed' : '';
    const border = rim
      ? ` The surface ends at its border, ${plural(rim.loops, 'closed curve')} of ${plural(rim.edges, 'edge')}${smoothed}.`
      : '';
    return `A part with edges: ${plural(patches, 'patch', 'patches')} between ${plural(edges, 'sharp edge')} of the mesh and ${plural(corners, 'corner')}.${border}${faded}`;
  }
  if (union)
    return `The union of ${plural(union.bodies, 'body', 'bodies')}, with ${plural(union.edges, 'sharp edge')} of the mesh.`;
  if (!scan) return '';
  const { size, cell, smooth } = scan;
  const blur = smooth > 0 ? `, smoothed by a Gaussian of ${formatSignificant(smooth, 2)} cells` : '';
  return `A scan, without sharp edges: its distance on a grid of ${size.map(formatCount).join(' × ')} cells of ${formatSignificant(cell)}${blur}.`;
}

/** Distances up to this share of the diagonal are rounding errors. */
const ROUNDING = 1e-9;

/**
 * Returns the rows about the distance of the new mesh from the old one, with explanations.
 * @param {MeshChange} change @param {boolean} [isOpen]  an open surface has no volume
 */
export function changeOf({ diagonal, to_new, to_old, edges, volume, area }, isOpen = false) {
  const far = (/** @type {number} */ largest) =>
    largest < ROUNDING * diagonal
      ? 'none but rounding'
      : `up to ${formatSignificant(largest)} (${formatShare(largest / diagonal, 4)} of the diagonal)`;
  const both = (/** @type {[number, number]} */ [old, now]) => {
    const by = formatShare(Math.abs(now / old - 1), 3);
    const change = by === formatShare(0, 3) ? 'the same' : `${now < old ? '−' : '+'}${by}`;
    return `${formatSignificant(old)} → ${formatSignificant(now)} (${change})`;
  };
  const more = (/** @type {MeshChange['to_new']} */ { mean, most }) =>
    `The mean is ${formatSignificant(mean)}, and 99\u202f% are below ${formatSignificant(most)}.`;
  return [
    {
      label: 'Old to new',
      value: far(to_new.largest),
      help: `Distances of points of the old mesh from the new one. ${more(to_new)}`,
    },
    {
      label: 'New to old',
      value: far(to_old.largest),
      help: `Distances of points of the new mesh from the old one. ${more(to_old)}`,
    },
    ...(edges === null
      ? []
      : [
          {
            label: 'Edges moved',
            value: far(edges),
            help: 'Largest distance of the sharp edges of the old mesh from the new one.',
          },
        ]),
    ...(isOpen ? [] : [{ label: 'Volume', value: both(volume), help: 'Of the old and of the new mesh.' }]),
    { label: 'Area', value: both(area), help: 'Of the old and of the new mesh.' },
  ];
}
