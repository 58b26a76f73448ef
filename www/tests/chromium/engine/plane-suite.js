/** The cutting plane in the picture: which side it hides, of discs, of the mesh and of the body beneath small discs. */
import { expect, test } from '@playwright/test';
import { halvesOf } from '../../pixels.js';
import { atRest, open, pixels, status } from './browser.js';

/**
 * @import { Page } from '@playwright/test'
 * @import { CuttingPlane } from '../../../src/engine/types.js'
 */

/** Seen from +x with z up: +y is on the right. */
const camera = { target: [0, 0, 0], distance: 6, yaw: 0, pitch: 0, fit: false };

/** @param {Page} page @param {object} view */
async function look(page, view) {
  await page.evaluate((v) => /** @type {any} */ (window).marchingParticles.engine.setView(v), view);
  await atRest(page);
}
/** @param {Page} page @param {CuttingPlane | null} plane */
async function cut(page, plane) {
  await page.evaluate((p) => /** @type {any} */ (window).marchingParticles.engine.setPlane(p), plane);
  await atRest(page);
}
const hasMesh = (/** @type {Page} */ page) => expect.poll(async () => (await status(page)).mesh !== null).toBe(true);

export const suite = () =>
  test('a cutting plane hides the side of its normal, of discs and of the mesh', { tag: '@all' }, async ({ page }) => {
    const { errors } = await open(page);
    const halves = async () => halvesOf(await pixels(page, 160, 120));
    for (const draw of ['discs', 'mesh']) {
      await look(page, { camera, draw });
      if (draw === 'mesh') await hasMesh(page);
      await atRest(page);
      const whole = await halves();
      expect(Math.min(...whole)).toBeGreaterThan(0.05);
      await cut(page, { normal: [0, 1, 0], offset: 0 });
      const left = await halves();
      expect(left[0]).toBeCloseTo(whole[0], 2);
      // Discs are whole: those at the plane reach beyond it.
      expect(left[1]).toBeLessThan(draw === 'mesh' ? 0.006 : 0.12 * whole[1]);
      await cut(page, { normal: [0, -4, 0], offset: 0 });
      const right = await halves();
      expect(right[1]).toBeCloseTo(whole[1], 2);
      expect(right[0]).toBeLessThan(draw === 'mesh' ? 0.006 : 0.12 * whole[0]);
      await cut(page, null);
      expect(await halves()).toEqual(whole);
    }

    // The body closes the gaps between small discs, and is cut with them.
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ settings: { radius_share: 0.03 } }));
    await look(page, { camera: { ...camera, distance: 4 }, draw: 'discs', size: 0.3, body: false });
    /** Share of pixels that are not quite the background. */
    const covered = async () => {
      const { pixels: bytes } = await pixels(page, 320, 240);
      let n = 0;
      for (let i = 0; i < bytes.length; i += 4) if (Math.abs(bytes[i] - bytes[0]) > 3) n += 1;
      return (4 * n) / bytes.length;
    };
    const bare = await covered();
    await look(page, { body: true });
    const above = await covered();
    expect(above).toBeGreaterThan(1.2 * bare);
    await look(page, { size: 0.92 });
    expect(above).toBeCloseTo(await covered(), 1.5);
    await look(page, { size: 0.3 });
    await cut(page, { normal: [0, 1, 0], offset: 0 });
    expect(await covered()).toBeLessThan(0.6 * above);
    expect(errors).toEqual([]);
  });
