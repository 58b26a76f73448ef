/** The mesh in the picture: that it is drawn, how its edges, marks and colours look, and when it comes and goes. */
import { expect, test } from '@playwright/test';
import { atRest, coarse, expectInside, link, open, picture, status } from './browser.js';

/**
 * @import { ViewState } from '../../src/engine/types.js'
 * @import { Page } from '@playwright/test'
 */

/** @param {Page} page @param {Partial<ViewState>} view */
async function look(page, view) {
  await page.evaluate((v) => /** @type {any} */ (window).marchingParticles.engine.setView(v), view);
  await expect.poll(async () => (await status(page)).mesh !== null).toBe(view.draw !== 'discs');
  await atRest(page);
}

/** Pixels of a small picture, in bytes. @param {Page} page @returns {Promise<number[]>} */
const pixels = (page) =>
  page.evaluate(async () => Array.from((await /** @type {any} */ (window).marchingParticles.pixels(160, 120)).pixels));

/** Share of the pixels that differ visibly. @param {number[]} a @param {number[]} b */
function differing(a, b) {
  let n = 0;
  for (let i = 0; i < a.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > 8)) n += 1;
  }
  return (4 * n) / a.length;
}

export const suite = () => {
  test('a mesh closes the gaps between discs, and every option of it can be seen', async ({ page }) => {
    const { errors } = await open(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ size: 0.3 }));
    await atRest(page);
    const discs = (await picture(page)).drawn;
    const plain = /** @type {const} */ ({
      draw: 'mesh',
      colour: 'level',
      faces: 'smooth',
      edges: false,
      marks: false,
    });
    await look(page, plain);
    // Through the gaps the inside of the far side is seen, which is drawn, too.
    expect((await picture(page)).drawn).toBeGreaterThan(1.25 * discs);
    const smooth = await pixels(page);
    for (const option of /** @type {const} */ ([
      { faces: 'flat' },
      { edges: true },
      { marks: true },
      { colour: 'normal' },
    ])) {
      await look(page, { ...plain, ...option });
      expect(differing(await pixels(page), smooth), JSON.stringify(option)).toBeGreaterThan(0.005);
    }
    await look(page, plain);
    expect(differing(await pixels(page), smooth)).toBe(0);
    expect(errors).toEqual([]);
  });

  test('a mesh is on the canvas in the colours that are read back', async ({ page }) => {
    await open(page);
    await look(page, { draw: 'mesh', colour: 'plain', edges: false, marks: false });
    const box = await page.locator('#stage canvas').boundingBox();
    if (!box) throw new Error('the canvas has no box');
    // A corner of the canvas that no panel covers shows the background alone.
    const shot = await page.screenshot({ clip: { x: box.x, y: box.y, width: 4, height: 4 } });
    const read = await page.evaluate(async () =>
      Array.from((await /** @type {any} */ (window).marchingParticles.pixels(16, 12)).pixels.subarray(0, 3)),
    );
    // Decoded in a page without a content security policy.
    const blank = await page.context().newPage();
    const seen = await blank.evaluate(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(4, 4).getContext('2d'));
      context.drawImage(image, 0, 0);
      return Array.from(context.getImageData(2, 2, 1, 1).data.subarray(0, 3));
    }, shot.toString('base64'));
    await blank.close();
    expect(seen).toEqual(read);
  });

  test('what is seen from behind is darker and greyer, on a light and on a dark ground', async ({ page }) => {
    await open(page);
    await expectInside(page, 'discs');
    await expectInside(page, 'mesh');
  });

  test('a mesh goes with its particles and comes back with the next ones', async ({ page }) => {
    const { errors } = await open(page, `./${link({ ...coarse, view: { draw: 'mesh' } })}`);
    await expect.poll(async () => (await status(page)).mesh?.components[0].euler).toBe(2);
    const before = (await status(page)).mesh.triangles;
    await page.evaluate(() =>
      /** @type {any} */ (window).marchingParticles.set({ surface: 'torus', settings: { radius_share: 0.015 } }),
    );
    await expect.poll(async () => (await status(page)).mesh?.components[0].euler).toBe(0);
    expect((await status(page)).mesh.triangles).not.toBe(before);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
    await expect.poll(async () => (await status(page)).notice?.text).toContain('is back');
    await atRest(page);
    expect((await picture(page)).drawn).toBeGreaterThan(0.1);
    expect(errors).toEqual([]);
  });
};
