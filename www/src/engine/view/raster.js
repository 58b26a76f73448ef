/**
 * Fills pixels for the painter: discs, balls, triangles and lines, each with a depth test. The functions return the
 * number of pixels visited, which the painter counts as work.
 *
 * @module
 */
import { COLOUR, packed } from './shade.js';

/** @import { PaintedBall, PaintedDisc, PaintedTriangle, Target } from './types.js' */

/** Radius on the screen below which a disc is drawn as one pixel. */
export const POINT_PX = 0.7;
/** Pixels from the middle of the table of a ball's light to its rim; then the table's side. */
const BALL_STEPS = 32;
export const BALL_SIDE = 2 * BALL_STEPS + 1;
/** How far the colour of a face moves towards the ink on its edges, as in shaders/faces.wgsl; then the ink. */
const EDGE_INK = 0.62;
const INK = 1 - Math.sqrt(0.08);

/**
 * Whether nothing of a disc can be seen: it is outside the picture, or a single pixel behind another surface.
 * @param {Target} target @param {{sx: number, sy: number}} at @param {number} px  its radius @param {number} near
 */
export function isHidden({ depth, width, height }, { sx, sy }, px, near) {
  if (sx + px < 0 || sy + px < 0 || sx - px > width || sy - px > height) return true;
  if (px >= POINT_PX) return false;
  return sx < 0 || sx >= width || sy < 0 || sy >= height || near <= depth[(sy | 0) * width + (sx | 0)];
}

/**
 * Fills the projected ellipse of a disc: dx² + dy² + dz² ≤ px² with dz = −(ka·dx + kb·dy), in pixels around its centre.
 * @param {Target} target @param {PaintedDisc} disc
 */
export function fillDisc({ out, depth, width, height }, { sx, sy, px, ka, kb, near, depthPerPx, value, rim, coreSq }) {
  const y0 = Math.max(0, Math.ceil(sy - px - 0.5));
  const y1 = Math.min(height - 1, Math.floor(sy + px - 0.5));
  const qa = 1 + ka * ka;
  let work = 0;
  for (let iy = y0; iy <= y1; iy += 1) {
    const dy = iy + 0.5 - sy;
    // (1 + ka²) dx² + 2 ka kb dy dx + (1 + kb²) dy² − px² ≤ 0
    const half = ka * kb * dy;
    const root = half * half - qa * ((1 + kb * kb) * dy * dy - px * px);
    if (root < 0) continue;
    const s = Math.sqrt(root);
    const x0 = Math.max(0, Math.ceil(sx + (-half - s) / qa - 0.5));
    const x1 = Math.min(width - 1, Math.floor(sx + (-half + s) / qa - 0.5));
    work += Math.max(0, x1 - x0 + 1);
    for (let ix = x0, at = iy * width + x0; ix <= x1; ix += 1, at += 1) {
      const dx = ix + 0.5 - sx;
      const dz = -(ka * dx + kb * dy);
      const depthHere = near + dz * depthPerPx;
      if (depthHere > depth[at]) {
        depth[at] = depthHere;
        out[at] = dx * dx + dy * dy + dz * dz > coreSq ? rim : value;
      }
    }
  }
  return work;
}

/**
 * Fills a ball that faces the eye. `lights` holds its light on a grid over its outline; COLOUR is its colour.
 * @param {Target} target @param {PaintedBall} ball
 */
export function fillBall({ out, depth, width, height }, { sx, sy, px, near, depthPerPx, lights, ground, away }) {
  const y0 = Math.max(0, Math.ceil(sy - px - 0.5));
  const y1 = Math.min(height - 1, Math.floor(sy + px - 0.5));
  const [r, g, b] = COLOUR;
  const scale = BALL_STEPS / px;
  const kept = 1 - away;
  let work = 0;
  for (let iy = y0; iy <= y1; iy += 1) {
    const dy = iy + 0.5 - sy;
    const half = Math.sqrt(Math.max(0, px * px - dy * dy));
    const x0 = Math.max(0, Math.ceil(sx - half - 0.5));
    const x1 = Math.min(width - 1, Math.floor(sx + half - 0.5));
    const row = BALL_SIDE * Math.round(BALL_STEPS + dy * scale) + BALL_STEPS;
    work += Math.max(0, x1 - x0 + 1);
    for (let ix = x0, at = iy * width + x0; ix <= x1; ix += 1, at += 1) {
      const dx = ix + 0.5 - sx;
      const depthHere = near + Math.sqrt(Math.max(0, px * px - dy * dy - dx * dx)) * depthPerPx;
      if (depthHere <= depth[at]) continue;
      depth[at] = depthHere;
      const light = 3 * (row + Math.round(dx * scale));
      out[at] = packed(
        Math.min(1, r * lights[light]) * kept + ground[0] * away,
        Math.min(1, g * lights[light + 1]) * kept + ground[1] * away,
        Math.min(1, b * lights[light + 2]) * kept + ground[2] * away,
      );
    }
  }
  return work;
}

/**
 * Calls a function for each point of such a grid, with the point's position on the ball: right, up, towards the eye.
 * Points outside the outline get the position of the rim.
 * @param {(at: number, x: number, y: number, z: number) => void} each
 */
export function overBall(each) {
  for (let row = 0; row < BALL_SIDE; row += 1) {
    for (let column = 0; column < BALL_SIDE; column += 1) {
      const [x, y] = [column / BALL_STEPS - 1, 1 - row / BALL_STEPS];
      const length = Math.max(1, Math.hypot(x, y));
      const z = Math.sqrt(Math.max(0, 1 - (x * x + y * y) / (length * length)));
      each(row * BALL_SIDE + column, x / length, y / length, z);
    }
  }
}

/**
 * Fills a triangle whose corners have a screen position, a depth and a colour in linear light. Its sides have lines
 * `linePx` wide, each drawn by its share `drawn`. Nothing is drawn where `beyond` is positive.
 * @param {Target} target @param {PaintedTriangle} triangle
 */
export function fillTriangle({ out, depth, width, height }, { x, y, near, colours, linePx, drawn, heights, beyond }) {
  const area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (area === 0) return 0;
  const y0 = Math.max(0, Math.ceil(Math.min(y[0], y[1], y[2]) - 0.5));
  const y1 = Math.min(height - 1, Math.floor(Math.max(y[0], y[1], y[2]) - 0.5));
  // The weight of corner k is a[k] x + b[k] in the row.
  const a = [(y[1] - y[2]) / area, (y[2] - y[0]) / area, (y[0] - y[1]) / area];
  const hasLines = linePx > 0 && (drawn[0] > 0 || drawn[1] > 0 || drawn[2] > 0);
  let work = 0;
  for (let iy = y0; iy <= y1; iy += 1) {
    const yc = iy + 0.5;
    let [lo, hi] = [0, width - 1];
    const b = [0, 0, 0];
    for (let k = 0; k < 3; k += 1) {
      const [p, q] = [(k + 1) % 3, (k + 2) % 3];
      b[k] = (x[p] * (y[q] - yc) - x[q] * (y[p] - yc)) / area;
      if (a[k] > 0) lo = Math.max(lo, Math.ceil(-b[k] / a[k] - 0.5));
      else if (a[k] < 0) hi = Math.min(hi, Math.floor(-b[k] / a[k] - 0.5));
      else if (b[k] < 0) hi = -1;
    }
    work += Math.max(0, hi - lo + 1);
    for (let ix = lo, at = iy * width + lo; ix <= hi; ix += 1, at += 1) {
      const u = a[0] * (ix + 0.5) + b[0];
      const v = a[1] * (ix + 0.5) + b[1];
      const w = 1 - u - v;
      const depthHere = u * near[0] + v * near[1] + w * near[2];
      if (depthHere <= depth[at]) continue;
      if (beyond && u * beyond[0] + v * beyond[1] + w * beyond[2] > 0) continue;
      depth[at] = depthHere;
      let kept = 1;
      if (hasLines) {
        const of = (/** @type {number} */ k, /** @type {number} */ weight) =>
          Math.min(1, Math.max(0, 0.5 * linePx + 0.5 - weight * heights[k])) * drawn[k];
        const line = Math.max(of(0, u), of(1, v), of(2, w)) * Math.min(linePx, 1);
        kept = (1 - EDGE_INK * INK * line) ** 2;
      }
      out[at] = packed(
        kept * (u * colours[0] + v * colours[3] + w * colours[6]),
        kept * (u * colours[1] + v * colours[4] + w * colours[7]),
        kept * (u * colours[2] + v * colours[5] + w * colours[8]),
      );
    }
  }
  return work;
}

/**
 * Draws a line one pixel wide, except where something hides it.
 * @param {Target} target
 * @param {{ ends: number[][], steps: number, value: number }} line  `ends`: horizontal and vertical clip coordinates
 *   and w of each; `steps`: number of equal parts between them, with a pixel at each end of a part
 */
export function paintLine({ out, depth, width, height }, { ends: [p, q], steps, value }) {
  for (let i = 0; i <= steps; i += 1) {
    const t = i / steps;
    const w = p[2] + (q[2] - p[2]) * t;
    if (!(w > 1e-9)) continue;
    const x = Math.floor((0.5 + (0.5 * (p[0] + (q[0] - p[0]) * t)) / w) * width);
    const y = Math.floor((0.5 - (0.5 * (p[1] + (q[1] - p[1]) * t)) / w) * height);
    if (x < 0 || y < 0 || x >= width || y >= height) continue;
    const at = y * width + x;
    if (1 / w > depth[at]) {
      depth[at] = 1 / w;
      out[at] = value;
    }
  }
}
