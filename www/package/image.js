/** Checks an image, and the options that choose a surface of it or of a mesh. @module */
import { flag, number, shown } from './checks.js';
import { InputError } from './errors.js';

/**
 * @import { GivenFile } from '../src/engine/files/types.js'
 * @import { Options } from './index.js'
 * @import { SentField, SentVoxels } from './protocol.js'
 */

/** The core's voxel type for each kind of array. @type {[Function, string][]} */
const TYPES = [
  [Uint8Array, 'uint8'],
  [Uint8ClampedArray, 'uint8'],
  [Int8Array, 'int8'],
  [Uint16Array, 'uint16'],
  [Int16Array, 'int16'],
  [Uint32Array, 'uint32'],
  [Int32Array, 'int32'],
  [BigUint64Array, 'uint64'],
  [BigInt64Array, 'int64'],
  [Float32Array, 'float32'],
  [Float64Array, 'float64'],
];
const AXES = [0, 1, 2];

/**
 * @typedef {{image: unknown, size?: unknown, spacing?: unknown, origin?: unknown, affine?: unknown, name?: unknown,
 *   beside?: unknown}} Given
 */

/** @param {object} given @returns {given is Given} */
export const isImage = (given) => /** @type {Partial<Given>} */ (given).image !== undefined;

/** @param {string} name @param {unknown} value @param {(v: number) => boolean} is @param {string} what */
function triple(name, value, is, what) {
  const list = Array.isArray(value) || ArrayBuffer.isView(value) ? [.../** @type {any} */ (value)] : [];
  if (list.length !== 3) throw new InputError(`${name}: three numbers, along x, y and z, not ${shown(value)}.`);
  return list.map((v, axis) => number(`${name}[${axis}]`, v, is, what));
}

/** The affine map from voxel indices to points, row by row. @param {Given} given */
function rowsOf({ spacing, origin, affine }) {
  if (affine !== undefined) {
    if (spacing !== undefined || origin !== undefined)
      throw new InputError('affine: in place of spacing and origin, not beside them.');
    const all = Array.isArray(affine) ? affine : [];
    const rows = all.slice(0, 3);
    if (rows.length !== 3 || all.length > 4 || rows.some((row) => row?.length !== 4))
      throw new InputError('affine: three or four rows of four numbers.');
    return rows.flatMap((row, r) => [...row].map((v, c) => number(`affine[${r}][${c}]`, v, () => true, 'a number')));
  }
  const lengths = typeof spacing === 'number' ? [spacing, spacing, spacing] : (spacing ?? [1, 1, 1]);
  const steps = triple('spacing', lengths, (v) => v > 0, 'a length above 0');
  const first = triple('origin', origin ?? [0, 0, 0], () => true, 'a number');
  return AXES.flatMap((r) => [...AXES.map((c) => (r === c ? steps[c] : 0)), first[r]]);
}

/** A file's content in the form in which it is sent. @param {unknown} content @returns {Blob | null} */
export function blobOf(content) {
  if (content instanceof Blob) return content;
  return content instanceof ArrayBuffer || ArrayBuffer.isView(content)
    ? new Blob([/** @type {ArrayBuffer} */ (content)])
    : null;
}

/** @param {unknown} beside @returns {GivenFile['beside']} */
function othersOf(beside) {
  if (beside === undefined) return [];
  const list = Array.isArray(beside) ? beside : [beside];
  return list.map((other, k) => {
    if (other instanceof Blob && 'name' in other) return { name: String(other.name), file: other };
    throw new InputError(`beside[${k}]: a File, whose name the header holds, not ${shown(other)}.`);
  });
}

/**
 * An array of voxels, or a file.
 * @param {Given} given @returns {SentVoxels | GivenFile}
 */
export function imageOf(given) {
  const { image, size, name } = given;
  const ownName = image instanceof Blob && 'name' in image ? String(image.name) : 'image';
  const called = name === undefined ? ownName : String(name);
  if (size === undefined) {
    const misplaced = ['spacing', 'origin', 'affine'].find(
      (key) => given[/** @type {keyof Given} */ (key)] !== undefined,
    );
    if (misplaced) throw new InputError(`${misplaced}: for an array of voxels with its size. A file has its own.`);
    const file = blobOf(image);
    if (!file) throw new InputError(`image: a File, a Blob, or the bytes of a file, not ${shown(image)}.`);
    return { as: 'image', name: called, file, beside: othersOf(given.beside) };
  }
  const type = TYPES.find(([Class]) => image instanceof Class)?.[1];
  if (!type) throw new InputError(`image: with a size it is a typed array of voxels, not ${shown(image)}.`);
  const array = /** @type {Uint8Array} */ (image);
  const sizes = triple('size', size, (n) => Number.isSafeInteger(n) && n > 0 && n < 2 ** 31, 'a whole number above 0');
  const wanted = sizes[0] * sizes[1] * sizes[2];
  if (array.length !== wanted)
    throw new InputError(`size: ${sizes.join(' × ')} voxels are ${wanted} values, and the array has ${array.length}.`);
  const voxels = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
  return { name: called, type, size: sizes, rows: rowsOf(given), voxels };
}

/** The options that choose a surface, and for what they are. @type {Record<string, ('image' | 'mesh')[]>} */
const CHOICES = {
  iso: ['image'],
  label: ['image'],
  darkInside: ['image'],
  closeBorder: ['image'],
  edges: ['mesh'],
  borders: ['mesh'],
  smooth: ['image', 'mesh'],
};

/** The core's angle of edges that stay sharp; 0 means none. @param {unknown} edges */
function angleOf(edges) {
  if (edges === 'none') return 0;
  return number('edges', edges, (v) => v >= 1 && v <= 180, "an angle from 1 to 180 degrees, 'auto' or 'none'");
}

/**
 * The choices for an image or a mesh, by their names in the core.
 * @param {Options} options @param {'image' | 'mesh' | null} kind
 * @returns {SentField['parameters']}
 */
export function valuesOf({ iso, label, smooth, darkInside, closeBorder, edges, borders }, kind) {
  for (const [name, value] of Object.entries({ iso, label, smooth, darkInside, closeBorder, edges, borders })) {
    if (value !== undefined && !(kind && CHOICES[name].includes(kind)))
      throw new InputError(
        `${name}: for ${CHOICES[name].map((of) => (of === 'image' ? 'an image' : 'a mesh')).join(' or ')}.`,
      );
  }
  if (iso !== undefined && label !== undefined) throw new InputError('iso, label: one of the two, not both.');
  /** @type {SentField['parameters']} */
  const values = {};
  if (iso !== undefined) values.iso = number('iso', iso, () => true, 'a number');
  if (label !== undefined) values.label = number('label', label, Number.isInteger, 'a whole number');
  const [widest, unit] = kind === 'mesh' ? [10, 'cells'] : [100, 'voxels'];
  if (smooth !== undefined)
    values.smooth = number('smooth', smooth, (v) => v >= 0 && v <= widest, `from 0 to ${widest} ${unit}`);
  if (darkInside !== undefined && flag('darkInside', darkInside)) values.dark = 1;
  if (closeBorder !== undefined && flag('closeBorder', closeBorder)) values.closed = 1;
  if (edges !== undefined && edges !== 'auto') values.edges = angleOf(edges);
  if (borders !== undefined) values.borders = flag('borders', borders) ? 1 : 0;
  return values;
}
