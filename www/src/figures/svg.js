/** Parts of drawings, in which y points up and lengths are in radii. */
import { s } from '../ui/dom.js';

/** @import { Point } from './types.js' */

/** Rounds a coordinate to four decimals. @param {number} value */
const short = (value) => String(Math.round(value * 1e4) / 1e4);

/** @param {string} kind  a class @param {Point} at @param {number} r */
export const ring = (kind, [x, y], r) => s('circle', { class: kind, cx: short(x), cy: short(-y), r: short(r) });

/** @param {string} kind @param {readonly Point[]} points */
export const line = (kind, points) =>
  s('polyline', { class: kind, points: points.map(([x, y]) => `${short(x)},${short(-y)}`).join(' ') });

/** @param {string} kind @param {Point} at @param {string} words */
export const label = (kind, [x, y], words) => s('text', { class: kind, x: short(x), y: short(-y) }, words);

/**
 * Draws segments as one path.
 * @param {string} kind @param {ArrayLike<number>} ends  x₀, y₀, x₁, y₁ of each @param {number} scale
 */
export function segments(kind, ends, scale) {
  let d = '';
  for (let k = 0; k + 3 < ends.length; k += 4) {
    const [ax, ay, bx, by] = [0, 1, 2, 3].map((j) => ends[k + j] * scale);
    d += `M${short(ax)} ${short(-ay)}L${short(bx)} ${short(-by)}`;
  }
  return s('path', { class: kind, d });
}

/**
 * Shapes of the fates, around the origin with half size 1; they differ even without colour.
 * @type {Record<string, string>}
 */
const SHAPES = {
  open: 'M-.7 0a.7.7 0 1 0 1.4 0a.7.7 0 1 0-1.4 0z',
  parent: 'M-.8-.8h1.6v1.6h-1.6z',
  added: 'M-.9 0a.9.9 0 1 0 1.8 0a.9.9 0 1 0-1.8 0z',
  matched: 'M0-1.1 1.100 0 0 1.100-1.100 0z',
  not_converged: 'M-.8-.8 .8 .8M-.8 .8 .8-.8',
  outside: 'M0-1 1 .8H-1z',
  undefined: 'M-.9 0H.9M0-.9V.9',
  capped: 'M-.9-.3H.9V.3H-.9z',
};

/** @param {string} fate @param {Point} at @param {number} size  half of it */
export const fateShape = (fate, [x, y], size) =>
  s('path', {
    class: `fate fate-${fate.replace('_', '-')}`,
    d: SHAPES[fate],
    transform: `translate(${short(x)} ${short(-y)}) scale(${size})`,
  });
