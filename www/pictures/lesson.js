/**
 * Takes the still pictures of the lesson from its own figures, from the built site: `npm run pictures:lesson [--
 * address]`.
 *
 * Writes learn/stills/*.webp: what stands in a figure's place without JavaScript, before it is live, and if it cannot
 * be; and a still of the comparison, for readers without JavaScript.
 */
import { writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { expect } from '@playwright/test';
import { launch } from './browser.js';

const [base = 'http://localhost:4517/'] = process.argv.slice(2);
const folder = fileURLToPath(new URL('../learn/stills/', import.meta.url));
/**
 * What is not of the picture. The bars of the costs are shown, since their still is for readers without JavaScript
 * alone.
 */
const STYLE = `.controls, .choices, .figure-count, .key, .scale, .bar, .check, .quiet, figcaption { display: none !important }
  .stage .compare-box, .stage :is(.predict-question, .predict-form), .stage > p { display: none !important } .told { min-height: 0 !important } .cost { display: table !important }`;

const browser = await launch();
const page = await browser.newPage({
  viewport: { width: 1040, height: 900 },
  colorScheme: 'light',
  reducedMotion: 'reduce',
  bypassCSP: true,
  serviceWorkers: 'block',
});
// Runs take long where a machine has other work.
page.setDefaultTimeout(300_000);
await page.goto(`${base}learn/`);
await page.addStyleTag({ content: STYLE });
for (const stage of await page.locator('[data-figure]').all()) {
  const name = await stage.getAttribute('data-figure');
  await stage.scrollIntoViewIfNeeded();
  await page.waitForFunction(
    (element) => /** @type {HTMLElement} */ (element).dataset.state === 'live',
    await stage.elementHandle(),
  );
  // A pair is drawn once it is asked for.
  if (name === 'draws') {
    await stage
      .locator('button')
      .last()
      .evaluate((one) => /** @type {HTMLElement} */ (one).click());
    await expect(stage.locator('.picture[data-drawn]')).toHaveCount(2, { timeout: 300_000 });
  }
  // The numbers wait for a guess.
  if (name === 'cost') {
    const question = page.locator('#predict-cost');
    await question
      .locator('button')
      .last()
      .evaluate((one) => /** @type {HTMLElement} */ (one).click());
    await expect(question).toHaveAttribute('data-state', 'open');
  }
  // A pair says over its pictures that it is measured.
  await expect(stage.locator('.pair-box .figure-status').filter({ hasText: /./ })).toHaveCount(0, { timeout: 60_000 });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await save(name ?? '', await stage.screenshot());
}
// It is as wide as a column.
await page.setViewportSize({ width: 640, height: 900 });
await page.goto(`${base}learn/#what-if`);
await page.reload();
await page.addStyleTag({ content: STYLE });
const bench = page.locator('#bench');
await expect(bench.locator('.picture[data-drawn]')).toHaveCount(2, { timeout: 60_000 });
await expect(bench.locator('.figure-status')).toBeEmpty();
await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
await save('what-if', await bench.locator('.pair').screenshot());

/** @param {string} name @param {Buffer} png */
async function save(name, png) {
  const bytes = await page.evaluate(
    async (picture) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(picture)], { type: 'image/png' }));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      canvas.getContext('2d')?.drawImage(bitmap, 0, 0);
      const webp = await canvas.convertToBlob({ type: 'image/webp', quality: 0.8 });
      return [
        ...new Uint8Array(await webp.arrayBuffer()),
        bitmap.width >> 8,
        bitmap.width & 255,
        bitmap.height >> 8,
        bitmap.height & 255,
      ];
    },
    [...png],
  );
  const size = bytes.splice(-4);
  await writeFile(`${folder}${name}.webp`, new Uint8Array(bytes));
  console.log(`${name}: ${bytes.length} bytes, ${size[0] * 256 + size[1]} × ${size[2] * 256 + size[3]}`);
}
await browser.close();
