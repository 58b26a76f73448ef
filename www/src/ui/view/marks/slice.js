/**
 * The voxels of an image on the cutting plane, seen from the hidden side. Everything that is kept lies behind the plane
 * there, so the picture of the voxels may cover it. A canvas holds them, and a matrix of CSS places it in perspective.
 */
import { signal } from '@preact/signals-core';
import { h } from '../../dom.js';
import { planeOf, sectionOf } from '../../space.js';
import { boxOf } from './box.js';
import { lay, pixelsOf, squareTo } from './slice-pixels.js';

/**
 * @import { Bounds, CuttingPlane, Engine, PictureWish, Vec3 } from '../../../engine/types.js'
 * @import { Mark } from '../types.js'
 */

/** Points on a side of the picture, at least and at most, and points for each voxel. */
const [LEAST, MOST, IN_A_VOXEL] = [32, 512, 2];

/**
 * A rectangle in the plane: a corner, its sides as vectors, the points along them, and the outline of the section in it
 * as a path of CSS.
 * @typedef {{corner: Vec3, sides: [Vec3, Vec3], size: [number, number], outline: string}} Rectangle
 */

/**
 * The rectangle around the part of a plane in a box.
 * @param {Bounds} bounds @param {CuttingPlane} plane @param {number} step  between two points
 * @returns {Rectangle | null}
 */
function rectangleOf(bounds, plane, step) {
  const section = sectionOf(bounds, plane);
  if (section.length === 0) return null;
  const { u, v } = planeOf(plane.normal);
  const along = (/** @type {Vec3} */ axis) => section.map((p) => p[0] * axis[0] + p[1] * axis[1] + p[2] * axis[2]);
  const [us, vs] = [along(u), along(v)];
  const [u0, v0] = [Math.min(...us), Math.min(...vs)];
  const [width, height] = [Math.max(...us) - u0, Math.max(...vs) - v0];
  const longer = Math.max(width, height, Number.MIN_VALUE);
  const points = Math.min(MOST, Math.max(LEAST, (IN_A_VOXEL * longer) / step)) / longer;
  const at = (/** @type {number} */ a, /** @type {number} */ b, /** @type {number} */ c) =>
    /** @type {Vec3} */ ([0, 1, 2].map((k) => a * u[k] + b * v[k] + c * plane.normal[k]));
  return {
    corner: at(u0, v0, plane.offset),
    sides: [at(width, 0, 0), at(0, height, 0)],
    size: [Math.max(2, Math.ceil(width * points)), Math.max(2, Math.ceil(height * points))],
    outline: `polygon(${us.map((at, k) => `${(100 * (at - u0)) / width}% ${(100 * (vs[k] - v0)) / height}%`).join(', ')})`,
  };
}

/** The corners of a rectangle, first along its first side. @param {Rectangle} rectangle */
const cornersOf = ({ corner, sides }) =>
  [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 1],
  ].map(([a, b]) => corner.map((c, k) => c + a * sides[0][k] + b * sides[1][k]));

/**
 * Returns what draws the voxels on the cutting plane over a picture of the surface, if there are any.
 * @param {Engine} engine @returns {NonNullable<PictureWish['over']>}
 */
export const sliceOver = (engine) => async (image, project) => {
  const [{ plane, bounds }, field, facts] = [engine.state.peek(), engine.field.peek(), engine.image.peek()];
  const box = bounds ?? field?.bounds;
  if (!plane || !box || !field?.image || !facts) return;
  const rectangle = rectangleOf(box, plane, Math.min(...facts.spacing));
  const values = rectangle && (await engine.section(rectangle));
  if (!rectangle || !values) return;
  const pixels = pixelsOf(values, facts, field.image);
  lay(image, { pixels, size: rectangle.size }, cornersOf(rectangle).map(project), sectionOf(box, plane).map(project));
};

/** @param {Engine} engine @returns {Mark} */
export function sliceMark(engine) {
  const box = boxOf(engine);
  const canvas = /** @type {HTMLCanvasElement} */ (h('canvas', { class: 'slice', 'aria-hidden': 'true' }));
  const context = canvas.getContext('2d');
  /** What the canvas shows, and what is being asked for. */
  let [shown, asked] = ['', ''];
  /** Counts the pictures on the canvas. */
  const revision = signal(0);
  /** The rectangle that the canvas shows. @type {Rectangle | null} */
  let drawn = null;

  /** Asks for the voxels in a rectangle, one question at a time. @param {Rectangle} rectangle @param {string} wanted */
  async function fill(rectangle, wanted) {
    if (asked || wanted === shown || !context) return;
    asked = wanted;
    const values = await engine.section(rectangle);
    asked = '';
    const [facts, info] = [engine.image.peek(), engine.field.peek()?.image];
    if (!values || !facts || !info) return;
    shown = wanted;
    drawn = rectangle;
    [canvas.width, canvas.height] = rectangle.size;
    context.putImageData(new ImageData(pixelsOf(values, facts, info), rectangle.size[0]), 0, 0);
    revision.value += 1;
  }

  return {
    handles: [canvas],
    shown: () => engine.state.value.plane !== null && engine.image.value !== null && Boolean(engine.field.value?.image),
    draw() {
      const [plane, bounds, facts] = [engine.state.value.plane, box.value, engine.image.value];
      const info = engine.field.value?.image;
      canvas.style.visibility = 'hidden';
      if (!plane || !bounds || !facts || !info) return;
      const rectangle = rectangleOf(bounds, plane, Math.min(...facts.spacing));
      if (!rectangle) return;
      const { name, label, iso, is_dark_inside: isDark } = info;
      void fill(rectangle, JSON.stringify([rectangle, name, label, iso, isDark]));
      if (revision.value === 0 || !drawn) return;
      const spots = cornersOf(drawn).map((place) => engine.project(place));
      const matrix = squareTo(spots, drawn.size);
      if (!matrix) return;
      canvas.style.visibility = '';
      canvas.style.transform = matrix;
      canvas.style.clipPath = drawn.outline;
    },
  };
}
