/** Lists the facts about a model from points. */
import { formatCount, formatSignificant } from '../format.js';

/** @import { ModelInfo } from '../../engine/types.js' */

const NORMALS = { given: 'given', from_mesh: 'from the mesh', estimated: 'estimated' };

/** @param {ModelInfo} info */
export function factsOf({ condition, residual_mean, residual_95, residual_max, normals }) {
  const share = (/** @type {number} */ v) => formatSignificant(v * 100, 2);
  return [
    {
      label: 'Normals',
      value: NORMALS[normals] ?? normals,
      unit: '',
      help: 'Where the directions came from: the file gave them, they are those of its triangles, or they were estimated from the neighbours of every point.',
    },
    {
      label: 'Condition number',
      value: formatSignificant(condition, 2),
      unit: '',
      help: 'How much the system of equations can magnify rounding errors. Up to about 10¹², double precision leaves enough digits for a picture.',
    },
    {
      label: 'Mean distance',
      value: share(residual_mean),
      unit: '%',
      help: 'Mean distance of all points from the surface, |f|/|∇f|, as a share of the diagonal of their box.',
    },
    {
      label: '95 % are nearer than',
      value: share(residual_95),
      unit: '%',
      help: 'Distance from the surface below which 95 % of all points are, as a share of the diagonal of their box.',
    },
    {
      label: 'Largest distance',
      value: share(residual_max),
      unit: '%',
      help: 'Distance of the farthest of all points from the surface, as a share of the diagonal of their box.',
    },
  ];
}

/** Describes the surface in plain words. @param {ModelInfo} info */
export const plainOf = ({ points, residual_mean }) =>
  `A smooth surface through ${formatCount(points)} points, on average ${formatSignificant(residual_mean * 100, 2)} % of their size away from them.`;

/**
 * Says what f is, and how many points and centres it has.
 * @param {ModelInfo} info
 */
export function fittedOf({ points, centres }) {
  const how =
    points === centres
      ? `interpolates all ${formatCount(points)} points`
      : `is fitted to ${formatCount(points)} points, with ${formatCount(centres)} as centres`;
  return `f ${how}, with their normals, by Hermite radial basis functions; its zeros are the surface.`;
}
