/**
 * Draws the centres of a model as dots on the picture.
 *
 * A dot is a pair of discs that face the eye, ink on a casing, with a fixed size on the screen. They follow the
 * particles in the same buffer, so that back ends need no code for them. Because they face the eye, they are written
 * again for every frame, which is cheap for the few hundred points of a model.
 *
 * @module
 */
import { NO_LEVEL } from '../columns.js';

/** @import { DotOptions, View } from './types.js' */

/** Radius of the ink, and width of the casing around it, in page pixels. */
const INK_PX = 1.7;
const CASING_PX = 0.9;
/**
 * Smallest radius of the ink in canvas pixels: renderers draw smaller discs as soft points, which would hide the ink.
 * Where a moving picture has few pixels it is at most this many page pixels.
 */
const LEAST_INK = 2.4;
const MOST_INK_PX = 3;

/**
 * @param {Float32Array} points  three numbers each
 * @param {View} view  made for page pixels
 * @param {DotOptions} options
 */
export function dotsOf(points, view, { px, size, lift, palette }) {
  const n = points.length / 3;
  const positions = new Float32Array(6 * n);
  const normals = new Float32Array(6 * n);
  const radii = new Float32Array(2 * n);
  const colours = new Uint32Array(2 * n);
  const { eye, forward } = view;
  const inkPx = Math.max(INK_PX, Math.min(MOST_INK_PX, LEAST_INK / px));
  for (let i = 0; i < n; i += 1) {
    const toEye = [0, 1, 2].map((k) => eye[k] - points[3 * i + k]);
    const distance = Math.hypot(toEye[0], toEye[1], toEye[2]) || 1;
    const depth = -(toEye[0] * forward[0] + toEye[1] * forward[1] + toEye[2] * forward[2]);
    const worldPerPx = view.worldPerPx * Math.max(depth, 0);
    for (const [j, radiusPx, colour] of [
      [2 * i, inkPx + CASING_PX, palette.casing],
      [2 * i + 1, inkPx, palette.ink],
    ]) {
      const radius = radiusPx * worldPerPx;
      // The ink lies in front of its casing by more than the resolution of the depth buffer.
      const forth = Math.min(lift + (j & 1 ? radius : 0), 0.5 * distance) / distance;
      for (let k = 0; k < 3; k += 1) {
        positions[3 * j + k] = points[3 * i + k] + toEye[k] * forth;
        normals[3 * j + k] = toEye[k] / distance;
      }
      radii[j] = radius / size;
      colours[j] = colour;
    }
  }
  return { positions, normals, radii, levels: new Uint32Array(2 * n).fill(NO_LEVEL), colours };
}
