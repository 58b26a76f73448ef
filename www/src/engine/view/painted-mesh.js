/**
 * Paints the faces of a mesh, with their edges and the marks on vertices, like shaders/faces.wgsl.
 *
 * @module
 */
import { grown, NO_LEVEL } from '../columns.js';
import { isBeyond } from './picking.js';
import { fillDisc, fillTriangle } from './raster.js';
import { COLOUR, lightOn, packed, SHADE, shade, smoothstep, takeColour } from './shade.js';

/** @import { CornerColumns, PaintedScene, Style } from './types.js' */

// As in shaders/faces.wgsl.
const EDGE_FADE_PX = /** @type {const} */ ([2.5, 9]);
const MARK_RADIUS = 0.36;
const MARK_LEAST_PX = 2;
const MARK_MOST = 0.9;
const MARK_CASING_PX = 1;
/** Marks with a larger radius, in page pixels, have a casing. */
const MARK_CASED_PX = 3.5;
/** Distance, in radii, by which a mark is moved towards the eye, so that no face cuts it. */
const MARK_LIFT = 0.25;
/** Share by which faces of earlier levels fade to the background, as in src/render/style.rs. */
const MUTE = 0.35;

const NORMAL = new Float64Array(3);
const X = new Float64Array(3);
const Y = new Float64Array(3);
const NEAR = new Float64Array(3);
const BEYOND = new Float64Array(3);
const COLOURS = new Float64Array(9);
const HEIGHTS = new Float64Array(3);
const DRAWN = new Float64Array(3);

export class PaintedMesh {
  /** Number of faces, and of the particles that they replace. */
  count = 0;
  particles = 0;

  #positions = new Float32Array(0);
  #normals = new Float32Array(0);
  #radii = new Float32Array(0);
  #levels = new Uint32Array(0);
  #colours = new Uint32Array(0);
  #marks = new Uint32Array(0);

  /**
   * Writes faces from `first` on, each with three corners, counter-clockwise seen from outside.
   * @param {number} first @param {CornerColumns} corners @param {Uint32Array} colours @param {Uint32Array} marks
   */
  write(first, { positions, normals, radii, levels }, colours, marks) {
    const last = 3 * first + radii.length;
    if (last > this.#radii.length) {
      this.#positions = grown(this.#positions, 3 * last);
      this.#normals = grown(this.#normals, 3 * last);
      this.#radii = grown(this.#radii, last);
      this.#levels = grown(this.#levels, last);
      this.#colours = grown(this.#colours, last);
      this.#marks = grown(this.#marks, last);
    }
    this.#positions.set(positions, 9 * first);
    this.#normals.set(normals, 9 * first);
    this.#radii.set(radii, 3 * first);
    this.#levels.set(levels, 3 * first);
    this.tint(first, colours, marks);
  }

  /** @param {number} first @param {Uint32Array} colours @param {Uint32Array} marks */
  tint(first, colours, marks) {
    this.#colours.set(colours, 3 * first);
    this.#marks.set(marks, 3 * first);
  }

  /** @param {number} count @param {number} particles */
  show(count, particles) {
    this.count = Math.min(count, this.#radii.length / 3);
    this.particles = particles;
    if (count > 0) return;
    this.#positions = new Float32Array(0);
    this.#normals = new Float32Array(0);
    this.#radii = new Float32Array(0);
    this.#levels = new Uint32Array(0);
    this.#colours = new Uint32Array(0);
    this.#marks = new Uint32Array(0);
  }

  /** The newest level among the corners of a face; `NO_LEVEL` if no corner has one. @param {number} face */
  #level(face) {
    let newest = -1;
    for (let k = 3 * face; k < 3 * face + 3; k += 1)
      if (this.#levels[k] !== NO_LEVEL) newest = Math.max(newest, this.#levels[k]);
    return newest < 0 ? NO_LEVEL : newest;
  }

  /**
   * Computes the screen positions of a face's corners. Returns whether the face is drawn at all.
   * @param {number} face @param {PaintedScene} scene @param {Float32Array} m  view @param {Style} style
   */
  #place(face, { target: { width, height } }, m, { plane = null }) {
    const p = this.#positions;
    let hidden = 0;
    for (let k = 0; k < 3; k += 1) {
      const [x, y, z] = [p[9 * face + 3 * k], p[9 * face + 3 * k + 1], p[9 * face + 3 * k + 2]];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (!(w > 1e-9) || !(this.#radii[3 * face + k] > 0)) return false;
      X[k] = (0.5 + (0.5 * (m[0] * x + m[4] * y + m[8] * z + m[12])) / w) * width;
      Y[k] = (0.5 - (0.5 * (m[1] * x + m[5] * y + m[9] * z + m[13])) / w) * height;
      NEAR[k] = 1 / w;
      if (!plane) continue;
      BEYOND[k] = plane.normal[0] * x + plane.normal[1] * y + plane.normal[2] * z - plane.offset;
      if (isBeyond(plane, p, 9 * face + 3 * k)) hidden += 1;
    }
    return hidden < 3 && Math.min(X[0], X[1], X[2]) < width && Math.max(X[0], X[1], X[2]) > 0;
  }

  /**
   * Paints a face.
   * @param {number} face @param {PaintedScene} scene @param {Float32Array} m  view @param {Style} style
   * @returns work, in pixels
   */
  paint(face, scene, m, style) {
    const level = this.#level(face);
    if (style.level !== null && style.level !== undefined && level !== NO_LEVEL && level > style.level) return 0;
    if (!this.#place(face, scene, m, style)) return 0;
    const { flat = false, edge_px = 0 } = style.faces ?? {};
    const { pixel_ratio: ratio = 1, plane = null } = style;
    const isOlder = style.level !== null && style.level !== undefined && level !== NO_LEVEL && level < style.level;
    const away = isOlder ? Math.max(style.dim, MUTE) : style.dim;
    const area = (X[1] - X[0]) * (Y[2] - Y[0]) - (X[2] - X[0]) * (Y[1] - Y[0]);
    // Screen coordinates point down, so a face seen from outside is clockwise in them.
    const isBehind = area > 0;
    const behind = isBehind ? style.dim_backfaces : 0;
    const inkPx = edge_px * ratio;
    for (let k = 0; k < 3; k += 1) {
      const [a, b] = [(k + 1) % 3, (k + 2) % 3];
      HEIGHTS[k] = Math.abs(area) / (Math.hypot(X[b] - X[a], Y[b] - Y[a]) || 1);
      DRAWN[k] = inkPx > 0 ? smoothstep([EDGE_FADE_PX[0] * ratio, EDGE_FADE_PX[1] * ratio], HEIGHTS[k]) : 0;
      if (!flat) {
        this.#light(face, k, isBehind, scene, m, style);
        takeColour(this.#colours[3 * face + k]);
        shade(1, behind, away, scene.ground);
        COLOURS.set(SHADE, 3 * k);
      }
    }
    if (flat) {
      this.#light(face, -1, isBehind, scene, m, style);
      const mean = [0, 0, 0];
      for (let k = 0; k < 3; k += 1) {
        takeColour(this.#colours[3 * face + k]);
        for (let c = 0; c < 3; c += 1) mean[c] += COLOUR[c] / 3;
      }
      COLOUR.set(mean);
      shade(1, behind, away, scene.ground);
      for (let k = 0; k < 3; k += 1) COLOURS.set(SHADE, 3 * k);
    }
    const beyond = plane ? BEYOND : null;
    const triangle = {
      x: X,
      y: Y,
      near: NEAR,
      colours: COLOURS,
      linePx: inkPx,
      drawn: DRAWN,
      heights: HEIGHTS,
      beyond,
    };
    let work = fillTriangle(scene.target, triangle);
    for (let k = 0; k < 3; k += 1)
      if (this.#marks[3 * face + k] >>> 24 >= 128) work += this.#mark(face, k, isBehind, scene, m, style, away);
    return work;
  }

  /**
   * Writes the light at a corner of a face, or on the whole face, and its normal, turned towards the eye.
   * @param {number} face @param {number} k  the corner; −1 for the face itself
   * @param {boolean} isBehind @param {PaintedScene} scene @param {Float32Array} m @param {Style} style
   */
  #light(face, k, isBehind, { axes: { up }, key, rim }, m, { warmth = 0 }) {
    const p = this.#positions.subarray(9 * face, 9 * face + 9);
    if (k < 0) {
      const [ux, uy, uz] = [p[3] - p[0], p[4] - p[1], p[5] - p[2]];
      const [vx, vy, vz] = [p[6] - p[0], p[7] - p[1], p[8] - p[2]];
      const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      const length = Math.hypot(n[0], n[1], n[2]) || 1;
      for (let c = 0; c < 3; c += 1) NORMAL[c] = n[c] / length;
    } else {
      for (let c = 0; c < 3; c += 1) NORMAL[c] = this.#normals[9 * face + 3 * k + c];
    }
    if (isBehind) for (let c = 0; c < 3; c += 1) NORMAL[c] = -NORMAL[c];
    const at = Math.max(0, k);
    const [x, y, z] = [m[16] - p[3 * at], m[17] - p[3 * at + 1], m[18] - p[3 * at + 2]];
    const along = (x * NORMAL[0] + y * NORMAL[1] + z * NORMAL[2]) / (Math.hypot(x, y, z) || 1);
    const facing = Math.min(1, Math.max(0, along));
    const skyward = NORMAL[0] * up[0] + NORMAL[1] * up[1] + NORMAL[2] * up[2];
    const keyward = NORMAL[0] * key[0] + NORMAL[1] * key[1] + NORMAL[2] * key[2];
    lightOn({ keyward, skyward, edgeOn: 1 - facing }, { rim, warmth });
  }

  /**
   * Paints the mark on a corner of a face, in the tangent plane there.
   * @param {number} face @param {number} k @param {boolean} isBehind @param {PaintedScene} scene
   * @param {Float32Array} m @param {Style} style @param {number} away
   */
  #mark(face, k, isBehind, scene, m, style, away) {
    const { target, axes, ground } = scene;
    const { pixel_ratio: ratio = 1, plane = null } = style;
    if (plane && BEYOND[k] > 0) return 0;
    this.#light(face, k, isBehind, scene, m, style);
    const w = 1 / NEAR[k];
    const pxPerWorld = (axes.clipXPerWorld * 0.5 * target.width) / w;
    const radius = this.#radii[3 * face + k];
    const px =
      pxPerWorld * Math.max(MARK_RADIUS * radius, Math.min((MARK_LEAST_PX * ratio) / pxPerWorld, MARK_MOST * radius));
    takeColour(this.#marks[3 * face + k]);
    shade(1, isBehind ? style.dim_backfaces : 0, away, ground);
    const value = packed(SHADE[0], SHADE[1], SHADE[2]);
    const rim = packed(ground[0], ground[1], ground[2]);
    const casing = px > MARK_CASED_PX * ratio ? MARK_CASING_PX * ratio : 0;
    const along = (/** @type {number[]} */ axis) => NORMAL[0] * axis[0] + NORMAL[1] * axis[1] + NORMAL[2] * axis[2];
    const c = Math.max(1 / 12, -along(axes.forward));
    return fillDisc(target, {
      sx: X[k],
      sy: Y[k],
      px: px + casing,
      ka: along(axes.right) / c,
      kb: -along(axes.up) / c,
      near: 1 / (w - MARK_LIFT * radius),
      depthPerPx: 1 / (pxPerWorld * w * w),
      value,
      rim,
      coreSq: px * px,
    });
  }
}
