/**
 * Draws the pictures of the gallery and the poster with the program itself, from the built site:
 * `npm run pictures [-- address [surface …]]`; with surfaces only theirs.
 *
 * Writes public/gallery/*.webp (one per surface and model, transparent) and public/poster.svg (the default surface as
 * dots on a body, what the page shows while it loads).
 */
import { mkdir, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { FIELD_OF_VIEW_RAD } from '../src/engine/view/camera.js';
import { launch } from './browser.js';

const PICTURE_PX = 160;
/** Drawn larger and scaled down: smoother edges than one sample per pixel. */
const DRAWN_PX = 480;
/** After so many the frame is exact to a fraction of a pixel. */
const FRAMING_ROUNDS = 6;
const POSTER_PX = 720;
/** Dots of the poster: its radius as a share of the box's diagonal. */
const POSTER_SHARE = 0.008;

const [base = 'http://localhost:4517/', ...wanted] = process.argv.slice(2);
const folder = fileURLToPath(new URL('../public/', import.meta.url));
await mkdir(`${folder}gallery`, { recursive: true });

const browser = await launch();
const page = await browser.newPage({ viewport: { width: 480, height: 480 }, colorScheme: 'light' });
await page.goto(`${base}?backend=webgl2`);
await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);

const initial = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.state.view.camera);
/** @type {string[]} */
const ids = await page.evaluate(() => {
  const { surfaces, models } = /** @type {any} */ (window).marchingParticles.engine.description.value;
  return [...surfaces, ...models].map((/** @type {{ id: string }} */ { id }) => id);
});
for (const id of ids) {
  if (wanted.length > 0 && !wanted.includes(id)) continue;
  const bytes = await page.evaluate(
    async ({ id, drawn, size, viewRad, initial, rounds }) => {
      const mp = /** @type {any} */ (window).marchingParticles;
      await mp.set({
        surface: id,
        settings: { radius_share: 0.0065 },
        view: { colour: 'level', points: false, camera: initial },
      });
      mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
      // The fit leaves room to turn; a still picture can fill its frame.
      const { positions, count } = mp.particles();
      const { yaw, pitch, distance, target } = mp.state.view.camera;
      const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
      // What comes nearer grows: a few rounds find the distance at which the outermost particle is just inside.
      let near = distance;
      for (let round = 0; round < rounds; round += 1) {
        let reach = 0;
        for (let i = 0; i < count; i += 1) {
          const [x, y, z] = [0, 1, 2].map((k) => positions[3 * i + k] - target[k]);
          const depth = near - (cy * cp * x + sy * cp * y + sp * z);
          reach = Math.max(
            reach,
            Math.abs(cy * y - sy * x) / depth,
            Math.abs(cp * z - cy * sp * x - sy * sp * y) / depth,
          );
        }
        near *= reach / (0.97 * Math.tan(viewRad / 2));
      }
      mp.engine.zoom(distance / near);
      const png = await mp.engine.savePng({ width: drawn, height: drawn, transparent: true });
      const bitmap = await createImageBitmap(png, { resizeWidth: size, resizeHeight: size, resizeQuality: 'high' });
      const canvas = new OffscreenCanvas(size, size);
      canvas.getContext('2d')?.drawImage(bitmap, 0, 0);
      const webp = await canvas.convertToBlob({ type: 'image/webp', quality: 0.82 });
      return [...new Uint8Array(await webp.arrayBuffer())];
    },
    { id, drawn: DRAWN_PX, size: PICTURE_PX, viewRad: FIELD_OF_VIEW_RAD, initial, rounds: FRAMING_ROUNDS },
  );
  await writeFile(`${folder}gallery/${id}.webp`, new Uint8Array(bytes));
  console.log(`${id} ${bytes.length} bytes`);
}

if (wanted.length > 0) {
  await browser.close();
  process.exit();
}

const dots = await page.evaluate(
  async ({ share, size, viewRad, initial }) => {
    const mp = /** @type {any} */ (window).marchingParticles;
    await mp.set({
      surface: mp.engine.description.value.surfaces[0].id,
      settings: { radius_share: share },
      view: { camera: initial },
    });
    const { count, positions, normals, radii } = mp.particles();
    // The page's own camera at its fit, so that the first picture takes the poster's place without a jump.
    const { yaw, pitch, distance, target } = mp.state.view.camera;
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const [right, up, back] = [
      [-sy, cy, 0],
      [-cy * sp, -sy * sp, cp],
      [cy * cp, sy * cp, sp],
    ];
    const along = (/** @type {number[]} */ v, /** @type {number[]} */ axis) =>
      v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
    const front = [];
    for (let i = 0; i < count; i += 1) {
      const position = [0, 1, 2].map((k) => positions[3 * i + k] - target[k]);
      const depth = distance - along(position, back);
      const scale = size / (2 * Math.tan(viewRad / 2) * depth);
      const [x, y] = [along(position, right) * scale, -along(position, up) * scale];
      const normal = [...normals.slice(3 * i, 3 * i + 3)];
      const toEye = [0, 1, 2].map((k) => back[k] * distance - position[k]);
      const facing = along(normal, toEye) / Math.hypot(...toEye);
      if (facing > 0.04) front.push({ x: x + size / 2, y: y + size / 2, facing, radius: radii[i] * scale });
    }
    return { front };
  },
  { share: POSTER_SHARE, size: POSTER_PX, viewRad: FIELD_OF_VIEW_RAD, initial },
);

/**
 * The convex outline of places, by Andrew's monotone chain.
 * @param {{x: number, y: number}[]} places
 */
function outlineOf(places) {
  const sorted = [...places].sort((p, q) => p.x - q.x || p.y - q.y);
  const half = (/** @type {{x: number, y: number}[]} */ along) => {
    /** @type {{x: number, y: number}[]} */
    const hull = [];
    for (const p of along) {
      for (let [a, b] = hull.slice(-2); b; [a, b] = hull.slice(-2)) {
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0) break;
        hull.pop();
      }
      hull.push(p);
    }
    return hull.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

// One path per class of foreshortening: a dot is a line of no length with a round cap.
const classes = 6;
const paths = Array.from({ length: classes }, (_, k) => {
  const members = dots.front.filter(({ facing }) => Math.min(classes - 1, Math.floor(facing * classes)) === k);
  const width = 2 * 0.92 * dots.front[0].radius * Math.sqrt((k + 0.5) / classes);
  let at = [0, 0];
  const d = members
    .map(({ x, y }) => {
      const [px, py] = [Math.round(x), Math.round(y)];
      const step = `m${px - at[0]} ${py - at[1]}h0`.replace(' -', '-');
      at = [px, py];
      return step;
    })
    .join('');
  return `<path stroke-width="${width.toFixed(1)}" d="${d}"/>`;
}).join('');
// The stroke reaches to the rims of the outermost dots.
const outline = outlineOf(dots.front)
  .map(({ x, y }) => `${Math.round(x)} ${Math.round(y)}`)
  .join(' ');
const body = `<path class="body" stroke-linejoin="round" stroke-width="${(1.6 * dots.front[0].radius).toFixed(1)}" d="M${outline}z"/>`;
const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${POSTER_PX} ${POSTER_PX}"><style>.body{fill:#c8d1d9;stroke:#c8d1d9}g{stroke:#e0e8ee}@media(prefers-color-scheme:dark){.body{fill:#252c32;stroke:#252c32}g{stroke:#37424b}}</style>${body}<g fill="none" stroke-linecap="round">${paths}</g></svg>`;
await writeFile(`${folder}poster.svg`, svg);
console.log(`poster ${svg.length} bytes, ${dots.front.length} dots`);
await browser.close();
