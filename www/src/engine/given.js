/**
 * The data that a file gave to a field.
 *
 * @module
 */

/** @import { FieldOk } from './types.js' */

/**
 * The name of the model, image or mesh whose surface is sampled, and what its file contains; null for a formula.
 * @param {FieldOk | null} field
 * @returns {{name: string, holds: 'points' | 'voxels' | 'faces'} | null}
 */
export function givenOf(field) {
  if (field?.model) return { name: field.model.name, holds: 'points' };
  if (field?.image) return { name: field.image.name, holds: 'voxels' };
  if (field?.mesh) return { name: field.mesh.name, holds: 'faces' };
  return null;
}
