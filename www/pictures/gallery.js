/**
 * Draws the pictures of the gallery with the program itself, from the built site:
 * `npm run pictures [-- address [surface …]]`; with surfaces only theirs.
 *
 * Writes public/gallery/*.webp, one per surface, model and computed image, transparent.
 */
import { mkdir, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { SCANS } from '../src/engine/scans.js';
import { FIELD_OF_VIEW_RAD } from '../src/engine/view/camera.js';
import { launch } from './browser.js';

const PICTURE_PX = 160;
/** Drawn larger and scaled down: smoother edges than one sample per pixel. */
const DRAWN_PX = 480;
/** After so many the frame is exact to a fraction of a pixel. */
const FRAMING_ROUNDS = 6;

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
ids.push(...SCANS.map(({ id }) => id));
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

await browser.close();
