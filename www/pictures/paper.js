/**
 * Turns the figures that `cargo xtask paper` has drawn into files for a page: uncompressed pixels to WebP, drawings as
 * they are.
 *
 * Usage: node pictures/paper.js FROM TO
 */
import { readdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { launch } from './browser.js';

const QUALITY = 0.8;

const [from, to] = process.argv.slice(2);
const browser = await launch();
const page = await browser.newPage();

/** A line with width and height, then red, green, blue and coverage of each pixel. @param {Buffer} bytes */
async function webp(bytes) {
  const end = bytes.indexOf(10);
  const [width, height] = bytes.subarray(0, end).toString().split(' ').map(Number);
  const compressed = await page.evaluate(
    async ({ data, width, height, quality }) => {
      const pixels = Uint8ClampedArray.from(atob(data), (letter) => letter.charCodeAt(0));
      const canvas = new OffscreenCanvas(width, height);
      canvas.getContext('2d')?.putImageData(new ImageData(pixels, width, height), 0, 0);
      return [...new Uint8Array(await (await canvas.convertToBlob({ type: 'image/webp', quality })).arrayBuffer())];
    },
    { data: bytes.subarray(end + 1).toString('base64'), width, height, quality: QUALITY },
  );
  return Uint8Array.from(compressed);
}

for (const name of await readdir(from)) {
  const bytes = await readFile(join(from, name));
  const isPixels = name.endsWith('.rgba');
  const written = isPixels ? await webp(bytes) : bytes;
  const path = join(to, name.replace('.rgba', '.webp'));
  await writeFile(path, written);
  console.log(`${path} ${written.length} bytes`);
}
await browser.close();
