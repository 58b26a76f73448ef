/**
 * Uploads the creases of a surface to the graphics device as thin lines. Particles on creases are drawn as dots on the
 * lines, because a disc on either side would stick out beyond the edge. Particles on a smooth join are
 * ordinary discs.
 *
 * @module
 */
import { PALETTES } from './palettes.js';

/**
 * @import { Columns } from '../types.js'
 * @import { Device, Look, Theme } from './types.js'
 */

/** Numbers per end: its position and the radius of its particle. */
export const END = 4;

/**
 * Returns the radii of rows `first` to `last` for the renderers. If a particle has several rows, only the first is
 * drawn, the others are 0. On a crease or at a tip it is a dot, with a negative radius.
 * @param {Columns} columns @param {number} first @param {number} last
 */
export function radiiOf({ radii, twins, segments, seams }, first, last) {
  if (first >= twins.length) return radii.subarray(first, last);
  const discs = new Set(seams);
  for (const row of segments) discs.delete(row);
  return radii.slice(first, last).map((radius, k) => {
    const row = first + k;
    if (row >= twins.length) return radius;
    if (twins[row] !== row) return 0;
    return discs.has(row) ? radius : -radius;
  });
}

/** Returns the ends of the crease segments for the renderers. @param {Columns} columns */
export function endsOf({ segments, positions, radii }) {
  const ends = new Float32Array(END * segments.length);
  segments.forEach((row, k) => {
    ends.set(positions.subarray(3 * row, 3 * row + 3), END * k);
    ends[END * k + 3] = radii[row];
  });
  return ends;
}

export class CreaseUpload {
  /**
   * The segments on the device, and the theme of their colours.
   * @type {{segments: Uint32Array, theme: Theme}}
   */
  #held;

  /** @param {Columns} columns */
  constructor(columns) {
    this.columns = columns;
    this.#held = { segments: new Uint32Array(0), theme: 'light' };
  }

  /** Marks everything for upload, for a new device. */
  restart() {
    this.#held = { segments: new Uint32Array(0), theme: 'light' };
  }

  /** Uploads the changes. @param {Device['renderer']} renderer @param {Look} look */
  write(renderer, { creases, theme }) {
    const { columns } = this;
    const segments = creases ? columns.segments : new Uint32Array(0);
    const held = this.#held;
    const isSame = segments === held.segments || segments.length + held.segments.length === 0;
    if (isSame && (theme === held.theme || segments.length === 0)) return;
    const ends = creases ? endsOf(columns) : new Float32Array(0);
    renderer.write_lines(ends, new Uint32Array(segments.length / 2).fill(PALETTES[theme].ink));
    this.#held = { segments, theme };
  }
}
