/** Lists the facts about a model from points. */
import { formatCount, formatSignificant } from '../format.js';

const NORMALS = { given: 'given', from_mesh: 'from the mesh', estimated: 'estimated' };

/**
 * @param {import('../../engine/types.js').ModelInfo} info
 * @returns {{ label: string, value: string, unit: string, help: string }[]}
 */
export function factsOf({ points, centres, condition, residual_mean, residual_max, normals }) {
  const rows = [
    { label: 'Points read', value: formatCount(points), unit: '', help: 'Points of the model or the file.' },
    {
      label: 'Points fitted',
      value: formatCount(centres),
      unit: '',
      help: 'Points that f is zero at, with its gradient along their normals: spread evenly over all that were read.',
    },
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
      value: formatSignificant(residual_mean * 100, 2),
      unit: '%',
      help: 'Mean distance of all points read from the surface, as a share of the diagonal of their box.',
    },
    {
      label: 'Largest distance',
      value: formatSignificant(residual_max * 100, 2),
      unit: '%',
      help: 'Largest distance of a point read from the surface, as a share of the diagonal of their box.',
    },
  ];
  // If every point is a centre, one row is enough.
  return points === centres
    ? rows
        .filter(({ label }) => label !== 'Points read')
        .map((row) => (row.label === 'Points fitted' ? { ...row, label: 'Points' } : row))
    : rows;
}
