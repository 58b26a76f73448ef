/**
 * Films a first minute on the page, from the built site: `npm run pictures:minute`.
 *
 * Writes docs/images/minute-light.webp and -dark: the opening, a formula is typed, its slider moves, and a mesh is made.
 */
import { writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { animation } from './animation.js';
import { launch } from './browser.js';

/** @import { Page } from '@playwright/test' */

const SIZE = { width: 1000, height: 620 };
/** Time for which a picture is shown, at least. */
const MS = 120;
const QUALITY = 0.62;
const FORMULA = 'x^2 + y^2 + z^2 = 1 + a sin(3x) sin(3y) sin(3z)';

const base = process.argv[2] ?? 'http://localhost:4517/';
const folder = fileURLToPath(new URL('../../docs/images/', import.meta.url));
const browser = await launch();

/** The picture of a page as lossy WebP. @param {Page} blank @param {Buffer} png */
async function compressed(blank, png) {
  const bytes = await blank.evaluate(
    async ({ data, quality }) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      canvas.getContext('2d')?.drawImage(bitmap, 0, 0);
      return [...new Uint8Array(await (await canvas.convertToBlob({ type: 'image/webp', quality })).arrayBuffer())];
    },
    { data: png.toString('base64'), quality: QUALITY },
  );
  return Buffer.from(bytes);
}

const run = (/** @type {Page} */ page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.run());

/**
 * What happens on the page.
 * @param {Page} page
 * @param {(ms?: number) => Promise<void>} shoot  takes a picture, which is shown for so long
 */
async function scenes(page, shoot) {
  const ready = page.evaluate(() => /** @type {any} */ (window).marchingParticles?.ready);
  let isReady = false;
  void ready.then(() => {
    isReady = true;
  });
  do await shoot();
  while (!isReady);
  // The first slider has shown that it can be dragged.
  await page.waitForTimeout(4000);
  await shoot(1000);

  await page.getByRole('textbox', { name: 'Formula' }).click();
  await page.keyboard.press('ControlOrMeta+A');
  for (let k = 0; k < FORMULA.length; k += 4) {
    await page.keyboard.insertText(FORMULA.slice(k, k + 4));
    await shoot();
  }
  await page.keyboard.press('Enter');
  await run(page);
  await page.waitForTimeout(1500);
  await shoot(1200);

  for (let k = 1; k <= 16; k += 1) {
    // As the slider is dragged.
    const a = 1 - 0.8 * Math.sin((Math.PI * k) / 16);
    await page.evaluate((a) => /** @type {any} */ (window).marchingParticles.engine.setParameter('a', a), a);
    await page.waitForTimeout(400);
    await shoot();
  }
  await run(page);
  await shoot(600);

  await page.getByRole('button', { name: 'Make a mesh' }).first().click();
  await page.getByText('Closed · 1 part').filter({ visible: true }).first().waitFor();
  await page.waitForTimeout(1500);
  await shoot(2500);
}

for (const theme of /** @type {const} */ (['light', 'dark'])) {
  const [page, blank] = [await browser.newPage({ viewport: SIZE, colorScheme: theme }), await browser.newPage()];
  await page.goto(`${base}?backend=canvas2d`);
  /** @type {{picture: Buffer, ms: number}[]} */
  const pictures = [];
  await scenes(page, async (ms = MS) => {
    await page.waitForTimeout(MS);
    pictures.push({ picture: await compressed(blank, await page.screenshot()), ms });
  });
  const film = animation({ pictures, ...SIZE });
  await writeFile(`${folder}minute-${theme}.webp`, film);
  console.log(`minute-${theme}.webp ${film.length} bytes, ${pictures.length} pictures`);
  await page.close();
  await blank.close();
}
await browser.close();
