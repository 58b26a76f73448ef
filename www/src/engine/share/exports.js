/**
 * Writes the particles as PLY (binary, little endian) or CSV, and the picture as PNG. Columns that are not known yet
 * are omitted.
 *
 * @module
 */
import { NO_PARENT, SINGULAR } from '../columns.js';

/** @typedef {import('../columns.js').Columns} Columns */

/** Number of CSV rows that are joined at a time. */
const ROWS = 8192;

/**
 * Returns a PLY file with one vertex per particle: position, normal, radius, generation level, parent (−1 for a seed),
 * valence (once the report has it), and a flag that is 1 next to a singular point.
 * @param {Columns} columns
 * @param {{comment: string}} options  one line that describes the contents; line breaks are removed
 * @returns {Blob}
 */
export function ply(columns, { comment }) {
  const { count, valence } = columns;
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `comment ${comment.replace(/[\r\n]+/g, ' ')}`,
    `element vertex ${count}`,
    ...['x', 'y', 'z', 'nx', 'ny', 'nz', 'radius'].map((name) => `property float ${name}`),
    'property uint level',
    'property int parent',
    ...(valence ? ['property uchar valence'] : []),
    'property uchar singular',
    'end_header',
    '',
  ].join('\n');
  const stride = 7 * 4 + 4 + 4 + (valence ? 2 : 1);
  const body = new DataView(new ArrayBuffer(count * stride));
  for (let i = 0, at = 0; i < count; i += 1, at += stride) {
    for (let k = 0; k < 3; k += 1) {
      body.setFloat32(at + 4 * k, columns.positions[3 * i + k], true);
      body.setFloat32(at + 12 + 4 * k, columns.normals[3 * i + k], true);
    }
    body.setFloat32(at + 24, columns.radii[i], true);
    body.setUint32(at + 28, columns.levels[i], true);
    body.setInt32(at + 32, columns.parents[i] === NO_PARENT ? -1 : columns.parents[i], true);
    if (valence) body.setUint8(at + 36, valence[i]);
    body.setUint8(at + stride - 1, columns.slots[i] & SINGULAR ? 1 : 0);
  }
  return new Blob([new TextEncoder().encode(header), body.buffer], { type: 'application/octet-stream' });
}

/**
 * Returns the same data as CSV text, one line per particle, with valence, nearest distance and residual once the report
 * has them. Reading a number back gives the same single-precision value.
 * @param {Columns} columns
 * @returns {Blob}
 */
export function csv(columns) {
  const { count, positions, normals, radii, levels, parents, slots, valence, nearest, residual } = columns;
  const names = ['x', 'y', 'z', 'nx', 'ny', 'nz', 'radius', 'level', 'parent'];
  if (valence && nearest && residual) names.push('valence', 'nearest', 'residual');
  names.push('singular');
  const parts = [`${names.join(',')}\n`];
  /** @type {string[]} */
  let rows = [];
  for (let i = 0; i < count; i += 1) {
    /** @type {(string | number)[]} */
    const row = [];
    for (let k = 0; k < 3; k += 1) row.push(single(positions[3 * i + k]));
    for (let k = 0; k < 3; k += 1) row.push(single(normals[3 * i + k]));
    row.push(single(radii[i]), levels[i], parents[i] === NO_PARENT ? -1 : parents[i]);
    if (valence && nearest && residual) row.push(valence[i], single(nearest[i]), single(residual[i]));
    row.push(slots[i] & SINGULAR ? 1 : 0);
    rows.push(row.join(','));
    if (rows.length === ROWS) {
      parts.push(`${rows.join('\n')}\n`);
      rows = [];
    }
  }
  if (rows.length) parts.push(`${rows.join('\n')}\n`);
  return new Blob(parts, { type: 'text/csv' });
}

/** Rounds to nine significant digits, which identify any single-precision number. @param {number} v */
const single = (v) => Number(v.toPrecision(9));

/** Largest width or height of a saved picture. */
export const LARGEST_PICTURE_PX = 8192;

/**
 * Encodes RGBA pixels, rows from the top, as PNG.
 * @param {number} width @param {number} height @param {Uint8Array<ArrayBuffer>} pixels
 * @returns {Promise<Blob>}
 */
export async function png(width, height, pixels) {
  const image = new ImageData(
    new Uint8ClampedArray(pixels.buffer, pixels.byteOffset, pixels.byteLength),
    width,
    height,
  );
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext('2d');
  if (!context) throw new Error('The browser gives no 2-D canvas to encode the picture with.');
  context.putImageData(image, 0, 0);
  return canvas.convertToBlob({ type: 'image/png' });
}
