/**
 * Uploads a mesh to the graphics device: faces with the data of their three corners, their colours, and marks on
 * vertices that do not have six neighbours.
 *
 * @module
 */
import { emptyLike } from '../columns.js';
import { classOfValence, coloursOf } from './colouring.js';
import { PALETTES } from './palettes.js';

/**
 * @import { Renderer } from '../../wasm/render-webgpu/render.js'
 * @import { Painter } from './painter.js'
 * @import { Columns, Mesh } from '../types.js'
 * @import { Look, Theme } from './types.js'
 */

/** Faces gathered at a time, which take 6 MB. */
const SLICE = 65_536;

/**
 * Returns the number of neighbours of every vertex inside the mesh; 0 for others.
 * @param {Uint32Array} triangles @param {number} count  of vertices
 */
export function valencesOf(triangles, count) {
  const valence = new Uint8Array(count);
  // Inside the mesh every neighbour follows the vertex in one triangle and precedes it in another, so the sum of
  // followers minus the sum of predecessors is 0. At a border the first and the last neighbour remain.
  const rest = new Int32Array(count);
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; k += 1) {
      const v = triangles[i + k];
      valence[v] += 1;
      rest[v] += triangles[i + ((k + 1) % 3)] - triangles[i + ((k + 2) % 3)];
    }
  }
  for (let v = 0; v < count; v += 1) if (rest[v] !== 0) valence[v] = 0;
  return valence;
}

/**
 * Returns the colour of the mark on every vertex, as in the colouring by neighbours; 0 for no mark.
 * @param {Uint32Array} triangles @param {number} count @param {Theme} theme
 */
export function marksOf(triangles, count, theme) {
  const palette = PALETTES[theme].valence;
  return Uint32Array.from(valencesOf(triangles, count), (valence) =>
    valence === 0 || valence === 6 ? 0 : palette[classOfValence(valence)],
  );
}

/**
 * Returns the values of a column at the corners of triangles.
 * @template {Float32Array | Uint32Array} T
 * @param {T} column @param {number} width  values per particle
 * @param {Uint32Array} corners
 */
function gather(column, width, corners) {
  const out = emptyLike(column, width * corners.length);
  for (let i = 0; i < corners.length; i += 1) {
    const from = width * corners[i];
    for (let k = 0; k < width; k += 1) out[width * i + k] = column[from + k];
  }
  return out;
}

export class FaceUpload {
  /** The mesh on the device. @type {Mesh | null} */
  #mesh;

  /** Whether colours may have changed since their upload. */
  #faded;

  /** Number of uploads. */
  #writes;

  /** @param {Columns} columns */
  constructor(columns) {
    this.columns = columns;
    this.#mesh = null;
    this.#faded = false;
    this.#writes = 0;
  }

  /** Marks everything for upload, for a new device. */
  restart() {
    this.#mesh = null;
  }

  recolour() {
    this.#faded = true;
  }

  /**
   * Uploads the changes.
   * @param {Renderer | Painter} renderer
   * @param {Look} look
   * @param {{drawn: boolean, range: [number, number] | null}} present  whether faces are drawn now, and the ends of the
   *   present colour ramp
   */
  write(renderer, look, { drawn, range }) {
    const { columns } = this;
    const mesh = drawn && columns.mesh && fits(renderer, columns.mesh, columns) ? columns.mesh : null;
    if (!mesh) {
      if (this.#mesh) renderer.set_faces(0, 0);
      this.#mesh = null;
      return;
    }
    const isNew = mesh !== this.#mesh;
    if (!isNew && !this.#faded) return;
    const { triangles } = mesh;
    const { count, positions, normals, radii, levels } = columns;
    const colours = coloursOf(look.colour, look.theme, columns, 0, count, range);
    const marks = look.marks ? marksOf(triangles, count, look.theme) : new Uint32Array(count);
    for (let from = 0; from < triangles.length; from += 3 * SLICE) {
      const corners = triangles.subarray(from, from + 3 * SLICE);
      const [of, on] = [gather(colours, 1, corners), gather(marks, 1, corners)];
      if (isNew) {
        const columns = [gather(positions, 3, corners), gather(normals, 3, corners), gather(radii, 1, corners)];
        renderer.write_faces(from / 3, columns[0], columns[1], columns[2], gather(levels, 1, corners), of, on);
      } else renderer.tint_faces(from / 3, of, on);
      this.#writes += 1;
    }
    if (isNew) renderer.set_faces(triangles.length / 3, count);
    this.#mesh = mesh;
    this.#faded = false;
  }
}

/**
 * Whether a device can draw a mesh over all particles.
 * @param {Renderer | Painter} renderer
 * @param {Mesh} mesh
 * @param {Columns} columns
 */
const fits = (renderer, { triangles }, { count }) =>
  triangles.length / 3 <= renderer.max_faces() && count <= renderer.max_particles();
