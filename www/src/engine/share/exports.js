/**
 * Writes the particles as PLY (binary, little endian) or CSV, their record as JSON, and the picture as PNG. Columns
 * that are not known yet are omitted.
 *
 * @module
 */
import { MEASURED } from '../columns.js';
import { NO_PARENT, SINGULAR } from '../core-numbers.js';

/** @import { Columns, Description, FileRecord } from '../types.js' */

/** The word before a record, and the longest line of a comment, as in src/export/record.rs. */
const MARK = 'marching_particles';
const LONGEST_LINE = 200;

/** Number of CSV rows joined at a time. */
const ROWS = 8192;

/**
 * @typedef {Description['columns'][number]} Column
 * @typedef {Columns & {values?: Record<string, Float32Array>}} Exported  with columns that a program has added
 */

/** Returns the positions in the best known precision. @param {Columns} columns */
const placesOf = ({ exact, positions }) => (exact.length > 0 ? exact : positions);

/** The columns that are the parts of a colour. */
const CHANNELS = ['red', 'green', 'blue'];

/** Returns the type of the values of a column, by its name in PLY. @param {Columns} columns @param {Column} column */
const typeOf = ({ exact }, { kind }) => (kind === 'coordinate' ? (exact.length > 0 ? 'double' : 'float') : kind);

/** A part of a colour in eight bits, as PLY has it. @param {number} part  from 0 to 1 */
const inEightBits = (part) => Math.round(255 * Math.min(1, Math.max(0, part || 0)));

/**
 * For each column name, the value of a particle.
 * @type {Record<string, (columns: Columns, i: number) => number | undefined>}
 */
const READ = {
  x: (columns, i) => placesOf(columns)[3 * i],
  y: (columns, i) => placesOf(columns)[3 * i + 1],
  z: (columns, i) => placesOf(columns)[3 * i + 2],
  nx: ({ normals }, i) => normals[3 * i],
  ny: ({ normals }, i) => normals[3 * i + 1],
  nz: ({ normals }, i) => normals[3 * i + 2],
  radius: ({ radii }, i) => radii[i],
  level: ({ levels }, i) => levels[i],
  parent: ({ parents }, i) => (parents[i] === NO_PARENT ? -1 : parents[i]),
  valence: ({ valence }, i) => valence?.[i],
  nearest: ({ nearest }, i) => nearest?.[i],
  residual: ({ residual }, i) => residual?.[i],
  singular: ({ slots }, i) => (slots[i] & SINGULAR ? 1 : 0),
  patch: ({ patch }, i) => patch?.[i],
  particle: ({ particle }, i) => particle?.[i],
  periodic: ({ periodic }, i) => periodic?.[i],
};

/**
 * Returns a function that reads a column.
 * @param {{name: string}} column
 * @returns {(columns: Exported, i: number) => number | undefined}
 */
const readerOf = ({ name }) => READ[name] ?? (({ values }, i) => values?.[name][i]);

/**
 * Columns with known values. Some are known only after the particles were measured, others only with creases or if
 * opposite faces are equal.
 * @param {Columns} columns
 * @param {readonly Column[]} all
 */
const known = (columns, all) =>
  all.filter(({ name }) => MEASURED.every((column) => column !== name || columns[column]));

/** Size of a value in bytes and the method that writes it, by type. */
const BINARY = {
  double: { bytes: 8, write: DataView.prototype.setFloat64 },
  float: { bytes: 4, write: DataView.prototype.setFloat32 },
  int: { bytes: 4, write: DataView.prototype.setInt32 },
  uint: { bytes: 4, write: DataView.prototype.setUint32 },
  uchar: { bytes: 1, write: DataView.prototype.setUint8 },
};

/**
 * Returns a binary PLY file with one vertex per particle.
 * @param {Exported} columns
 * @param {readonly Column[]} all  all columns, as the core describes them
 * @param {FileRecord | null} record
 */
export function ply(columns, all, record) {
  const { count } = columns;
  const isColour = CHANNELS.every((name) => columns.values?.[name]);
  const some = known(columns, all).map((column) =>
    isColour && CHANNELS.includes(column.name) ? /** @type {Column} */ ({ ...column, kind: 'uchar' }) : column,
  );
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    'comment Marching Particles',
    ...commentsOf('comment', record),
    `element vertex ${count}`,
    ...some.map((column) => `property ${typeOf(columns, column)} ${column.name}`),
    'end_header',
    '',
  ].join('\n');
  const stride = some.reduce((sum, column) => sum + BINARY[typeOf(columns, column)].bytes, 0);
  const body = new DataView(new ArrayBuffer(count * stride));
  let offset = 0;
  for (const column of some) {
    const { bytes, write } = BINARY[typeOf(columns, column)];
    const read = readerOf(column);
    const isPart = isColour && CHANNELS.includes(column.name);
    for (let i = 0, at = offset; i < count; i += 1, at += stride) {
      const value = read(columns, i) ?? 0;
      write.call(body, at, isPart ? inEightBits(value) : value, true);
    }
    offset += bytes;
  }
  return new Blob([new TextEncoder().encode(header), body.buffer], { type: 'application/octet-stream' });
}

/**
 * Returns the same data as CSV text: the names of the columns in the first line, as spreadsheets and data frames
 * expect, then one line per particle. Reading a number back gives the same value.
 * @param {Exported} columns
 * @param {readonly Column[]} all  all columns, as the core describes them
 */
export function csv(columns, all) {
  const some = known(columns, all);
  const parts = [`${some.map(({ name }) => name).join(',')}\n`];
  const readers = some.map((column) => {
    const read = readerOf(column);
    return typeOf(columns, column) === 'float'
      ? (/** @type {number} */ i) => single(read(columns, i) ?? 0)
      : (/** @type {number} */ i) => read(columns, i);
  });
  /** @type {string[]} */
  let rows = [];
  for (let i = 0; i < columns.count; i += 1) {
    rows.push(readers.map((read) => read(i)).join(','));
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

/** The record as JSON in printable ASCII. @param {FileRecord} record */
function jsonOf(record) {
  const escaped = (/** @type {string} */ c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, '0')}`;
  return JSON.stringify(record).replace(/[^ -%'-;=?-~]/g, escaped);
}

/** Returns the record of the particles as a JSON file. @param {FileRecord} record */
export const json = (record) => new Blob([`{"${MARK}":${jsonOf(record)}}\n`], { type: 'application/json' });

/**
 * The comments with the record of the particles, as in src/export/record.rs: short lines, each continuing the one
 * before.
 * @param {string} begin @param {FileRecord | null} record
 */
function commentsOf(begin, record) {
  const start = `${begin} ${MARK} `;
  const lines = [];
  let rest = record ? jsonOf(record) : '';
  while (rest) {
    const most = Math.min(LONGEST_LINE - start.length, rest.length);
    let at = most;
    // Programs that rewrite the comments may drop spaces at the ends of lines.
    while (at > 0 && (rest[at - 1] === ' ' || rest[at] === ' ')) at -= 1;
    at ||= most;
    lines.push(start + rest.slice(0, at));
    rest = rest.slice(at);
  }
  return lines;
}

/** Encodes a picture as PNG. @param {ImageData} image */
export async function png(image) {
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d');
  if (!context) throw new Error('The browser gives no 2-D canvas to encode the picture with.');
  context.putImageData(image, 0, 0);
  return canvas.convertToBlob({ type: 'image/png' });
}
