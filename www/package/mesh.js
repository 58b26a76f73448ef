/** Checks a triangle mesh that is to be sampled again. @module */
import { shown, vectors } from './checks.js';
import { InputError } from './errors.js';
import { blobOf } from './image.js';

/**
 * @import { GivenFile } from '../src/engine/files/types.js'
 * @import { SentFaces } from './protocol.js'
 */

/** @typedef {{mesh: unknown, name?: unknown}} Given */

/** @param {object} given @returns {given is Given} */
export const isMesh = (given) => /** @type {Partial<Given>} */ (given).mesh !== undefined;

/** The vertices of the faces, three each. @param {unknown} faces @param {number} count  of vertices */
function facesOf(faces, count) {
  const rows = Array.isArray(faces) || ArrayBuffer.isView(faces) ? /** @type {any[]} */ (faces) : [];
  const flat = Array.isArray(rows[0]) ? rows.flat() : [...rows];
  if (flat.length === 0 || flat.length % 3 !== 0)
    throw new InputError(`faces: three vertices for each, not ${flat.length} numbers.`);
  const wrong = flat.findIndex((v) => !Number.isInteger(v) || v < 0 || v >= count);
  if (wrong >= 0)
    throw new InputError(`faces[${wrong}]: the index of one of ${count} vertices, not ${shown(flat[wrong])}.`);
  return new Uint32Array(flat);
}

/**
 * The arrays of a mesh, or its file.
 * @param {Given} given @returns {SentFaces | GivenFile}
 */
export function meshOf({ mesh, name }) {
  const ownName = mesh instanceof Blob && 'name' in mesh ? String(mesh.name) : 'mesh';
  const called = name === undefined ? ownName : String(name);
  const arrays = /** @type {{points?: unknown, faces?: unknown} | null} */ (mesh);
  if (arrays?.points !== undefined && arrays.faces !== undefined) {
    const points = vectors('points', arrays.points);
    return { name: called, points, faces: facesOf(arrays.faces, points.length / 3) };
  }
  const file = blobOf(mesh);
  if (!file) throw new InputError(`mesh: {points, faces}, a File, a Blob, or the bytes of a file, not ${shown(mesh)}.`);
  return { as: 'mesh', name: called, file, beside: [] };
}
