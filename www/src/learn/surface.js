/** The surface of the lesson: the learner's own, or the ellipsoid. */
import { unpackCarried } from '../ui/surface-link.js';

/**
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { OwnSurface } from './types.js'
 */

/** @type {FormulaSurface} */
const ELLIPSOID = {
  formula: 'x^2 + y^2/0.49 + z^2/0.25 = 1',
  parameters: [],
  bounds: { min: [-1.25, -1.05, -0.85], max: [1.25, 1.05, 0.85] },
};

/** @param {string | undefined} text  what the address carries @returns {OwnSurface} */
export function subjectOf(text) {
  if (text === undefined) return { surface: ELLIPSOID, isOwn: false, from: '', notice: '' };
  const carried = unpackCarried(text);
  if (!carried)
    return {
      surface: ELLIPSOID,
      isOwn: false,
      from: '',
      notice: 'The link holds no surface that can be read. The figures show an ellipsoid.',
    };
  const { surface, from } = carried;
  if (surface) return { surface, isOwn: true, from, notice: '' };
  const notice = 'Your surface comes from points, which a link cannot hold. The figures show an ellipsoid.';
  return { surface: ELLIPSOID, isOwn: false, from, notice };
}
