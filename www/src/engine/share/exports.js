/**
 * The particles as files: PLY (binary, little endian) and CSV, and the picture as PNG. Columns that are not known yet are left
 * out.
 *
 * @module
 */
import { NO_PARENT, SINGULAR } from '../columns.js';

/** @typedef {import('../columns.js').Columns} Columns */

/** Rows of CSV text put together at a time. */
const ROWS = 8192;

/**
 * One vertex per particle: position, normal, radius, generation level, parent (−1 for a seed), valence (only once the report
 * has counted it) and 1 next to a singular point.
 * @param {Columns} columns
 * @param {{comment: string}} options  one line on what this is; line breaks are taken out
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
 * The same as text, one line per particle; valence, nearest distance and residual where the report has them. Numbers are
 * written so that reading them gives the same single-precision value.
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

/** Nine significant digits hold any single-precision number. @param {number} v */
const single = (v) => Number(v.toPrecision(9));

/** Largest side of a picture. */
export const LARGEST_PICTURE_PX = 8192;

/**
 * A PNG of pixels, rows from the top, red, green, blue, opacity.
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
