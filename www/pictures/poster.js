/**
 * Draws public/poster.svg, what the page shows while it loads: the outline of the default surface as the page's camera
 * fits it, in the light and the colour of a body whose particles are still to come. `npm run pictures:poster`
 */
import { writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { homeCamera, rayThrough, viewOf } from '../src/engine/view/camera.js';
import { linear } from '../src/engine/view/oklab.js';
import { PALETTES } from '../src/engine/view/palettes.js';
import { COLOUR, lightOn, lit, rimOn } from '../src/engine/view/shade.js';

/** Side of the free square of the window, in units of the poster. */
const SIDE = 720;
/** Margin around the square, since the surface may reach beyond it. The width in view.css counts with it. */
const MARGIN = 36;
/** Half axes of the default surface, and the distance from which its outline fills the square (`status` of the page). */
const HALF = [1, 0.7, 0.5];
const DISTANCE = 3.317;
/** Direction to the key light in the view, as in src/render/style.rs. */
const KEY = [-0.5, 0.72, 0.55];
/** Share of a body to come that is ground, as in shaders/discs.wgsl. */
const TO_COME = 0.72;
/** Stops of the gradient. */
const STOPS = 7;

const view = viewOf({ ...homeCamera(), distance: DISTANCE }, SIDE, SIDE, { centre: [0, 0, 0], radius: 1.4 }, undefined);
const { packed: m, eye, right, up, forward } = view;
const dot = (/** @type {ArrayLike<number>} */ p, /** @type {ArrayLike<number>} */ q) =>
  p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
/** Row r of the map from the world to the square, with w last. @param {0 | 1 | 3} r */
const row = (r) => [m[r], m[4 + r], m[8 + r], m[12 + r]];
const [x, y, w] = [row(0), row(1), row(3)];
const rows = [x.map((v, k) => 0.5 * SIDE * (v + w[k])), y.map((v, k) => 0.5 * SIDE * (w[k] - v)), w];

// The outline of a quadric with the dual matrix D, seen by P, is the conic with the dual matrix P D Pt.
const dual = [...HALF.map((half) => half * half), -1];
const c = rows.map((p) => rows.map((q) => p.reduce((sum, v, k) => sum + v * dual[k] * q[k], 0)));
const centre = [c[0][2] / c[2][2], c[1][2] / c[2][2]];
/** The square of its half width along a direction. @param {number} i @param {number} k */
const spread = (i, k) => centre[i] * centre[k] - c[i][k] / c[2][2];
const [xx, xy, yy] = [spread(0, 0), spread(0, 1), spread(1, 1)];
const [mean, half] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
const radii = [Math.sqrt(mean + half), Math.sqrt(mean - half)];
const angle = 0.5 * Math.atan2(2 * xy, xx - yy);

/** Ends of the gradient: the outline on the side of the light on the screen, and the one opposite. */
const aim = Math.hypot(KEY[0], KEY[1]);
const [alongX, alongY] = [KEY[0] / aim, -KEY[1] / aim];
const reach =
  1 / Math.sqrt((alongX * (alongX * yy - alongY * xy) + alongY * (alongY * xx - alongX * xy)) / (xx * yy - xy * xy));

/** The unit normal of the surface where it is seen at a place of the square. @param {number} px @param {number} py */
function normalAt(px, py) {
  const ray = rayThrough(view, px, py).map((v, k) => v / HALF[k]);
  const from = [...eye].map((v, k) => v / HALF[k]);
  const [a, b, at] = [dot(ray, ray), dot(ray, from), dot(from, from) - 1];
  const t = (-b - Math.sqrt(Math.max(0, b * b - a * at))) / a;
  const n = from.map((v, k) => (v + t * ray[k]) / HALF[k]);
  return n.map((v) => v / Math.sqrt(dot(n, n)));
}

/** Colours along the gradient. @param {'light' | 'dark'} theme */
function colours(theme) {
  const palette = PALETTES[theme];
  const rgb = (/** @type {number} */ colour) => [0, 8, 16].map((shift) => linear(((colour >> shift) & 255) / 255));
  const ground = rgb(palette.ground);
  const length = Math.hypot(...KEY);
  const key = [0, 1, 2].map((k) => (right[k] * KEY[0] + up[k] * KEY[1] - forward[k] * KEY[2]) / length);
  return Array.from({ length: STOPS }, (_, i) => {
    const share = 0.98 * (1 - (2 * i) / (STOPS - 1)) * reach;
    const n = normalAt(centre[0] + share * alongX, centre[1] + share * alongY);
    lightOn(
      { keyward: dot(n, key), skyward: dot(n, up), edgeOn: 1 + dot(n, forward) },
      { rim: rimOn(ground), warmth: 0 },
    );
    COLOUR.set(rgb(palette.body));
    const pixel = lit(1, 0, TO_COME, ground);
    return `#${[0, 8, 16].map((shift) => ((pixel >> shift) & 255).toString(16).padStart(2, '0')).join('')}`;
  });
}

const number = (/** @type {number} */ value) => String(Math.round(10 * value) / 10);
const end = (/** @type {number} */ sign) =>
  [centre[0] + sign * reach * alongX, centre[1] + sign * reach * alongY].map(number);
const [[x1, y1], [x2, y2]] = [end(1), end(-1)];
const [light, dark] = [colours('light'), colours('dark')];
const stops = light
  .map((colour, i) => `<stop offset="${number((100 * i) / (STOPS - 1))}%" stop-color="${colour}" class="s${i}"/>`)
  .join('');
const style = dark.map((colour, i) => `.s${i}{stop-color:${colour}}`).join('');
const place = `rotate(${number((180 * angle) / Math.PI)} ${centre.map(number).join(' ')})`;
const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="${-MARGIN} ${-MARGIN} ${SIDE + 2 * MARGIN} ${SIDE + 2 * MARGIN}"><style>@media(prefers-color-scheme:dark){${style}}</style><linearGradient id="g" gradientUnits="userSpaceOnUse" x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}">${stops}</linearGradient><g fill="url(#g)"><ellipse cx="${number(centre[0])}" cy="${number(centre[1])}" rx="${number(radii[0])}" ry="${number(radii[1])}" transform="${place}"/></g></svg>
`;
await writeFile(fileURLToPath(new URL('../public/poster.svg', import.meta.url)), svg);
console.log(`poster ${svg.length} bytes`);
