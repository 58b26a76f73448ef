/** The cutting plane in the picture: which side it hides, of discs and of the mesh, without sampling anything anew. */
import { expect, test } from '@playwright/test';
import { atRest, link, open, status } from './browser.js';

/**
 * @import { CuttingPlane } from '../../src/engine/types.js'
 * @import { Page } from '@playwright/test'
 */

/** Seen from +x with z up: +y is on the right. */
const camera = { target: [0, 0, 0], distance: 6, yaw: 0, pitch: 0, fit: false };

/** Shares of the left and of the right half of a picture in which something is drawn. @param {Page} page */
const halves = (page) =>
  page.evaluate(async () => {
    const { pixels, width, height } = await /** @type {any} */ (window).marchingParticles.pixels(160, 120);
    const seen = [0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      const drawn = [0, 1, 2].some((k) => Math.abs(pixels[i + k] - pixels[k]) > 24);
      if (drawn) seen[(i / 4) % width < width / 2 ? 0 : 1] += 2 / (width * height);
    }
    return seen;
  });

/** @param {Page} page @param {CuttingPlane | null} plane */
async function cut(page, plane) {
  await page.evaluate((p) => /** @type {any} */ (window).marchingParticles.engine.setPlane(p), plane);
  await atRest(page);
}

/** @param {{mesh: boolean}} options  whether the back end draws meshes */
export const suite = ({ mesh }) => {
  for (const draw of mesh ? ['discs', 'mesh'] : ['discs']) {
    test(`a cutting plane hides the side of its normal, of ${draw}`, async ({ page }) => {
      const { errors } = await open(page);
      await page.evaluate(
        ([view, free]) => {
          const { engine } = /** @type {any} */ (window).marchingParticles;
          engine.setInsets(free);
          engine.setView(view);
        },
        /** @type {const} */ ([
          { camera, draw },
          { left: 0, right: 0, top: 0, bottom: 0 },
        ]),
      );
      if (draw === 'mesh') await expect.poll(async () => (await status(page)).mesh !== null).toBe(true);
      await atRest(page);
      const { progress } = await status(page);
      const whole = await halves(page);
      expect(Math.min(...whole)).toBeGreaterThan(0.05);
      await cut(page, { normal: [0, 1, 0], offset: 0 });
      const left = await halves(page);
      expect(left[0]).toBeCloseTo(whole[0], 2);
      // Discs are whole: those at the plane reach beyond it.
      expect(left[1]).toBeLessThan(draw === 'mesh' ? 0.006 : 0.12 * whole[1]);
      // The normal need not have length 1.
      await cut(page, { normal: [0, -4, 0], offset: 0 });
      const right = await halves(page);
      expect(right[1]).toBeCloseTo(whole[1], 2);
      expect(right[0]).toBeLessThan(draw === 'mesh' ? 0.006 : 0.12 * whole[0]);
      await cut(page, null);
      expect(await halves(page)).toEqual(whole);
      expect((await status(page)).progress.run).toBe(progress.run);
      expect(errors).toEqual([]);
    });
  }

  test('what a cutting plane hides is not picked, and what is behind it is', async ({ page }) => {
    await open(page);
    const picked = () =>
      page.evaluate(
        (view) => {
          const { engine, particles } = /** @type {any} */ (window).marchingParticles;
          engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
          engine.setView(view);
          const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
          const index = engine.pick(host.clientWidth / 2, host.clientHeight / 2);
          return index === null ? null : particles().positions[3 * index];
        },
        /** @type {any} */ ({ camera }),
      );
    expect(await picked()).toBeGreaterThan(0.9);
    await cut(page, { normal: [1, 0, 0], offset: 0 });
    expect(await picked()).toBeLessThan(-0.9);
    await cut(page, { normal: [1, 0, 0], offset: -2 });
    expect(await picked()).toBe(null);
  });

  if (mesh) {
    test('the surface is seen faintly beneath small discs, and is cut with them', async ({ page }) => {
      const { errors } = await open(page, `./${link({ settings: { radius_share: 0.03 } })}`);
      await page.evaluate(
        ([view]) => /** @type {any} */ (window).marchingParticles.engine.setView(view),
        /** @type {const} */ ([{ camera: { ...camera, distance: 4 }, size: 0.3 }]),
      );
      await atRest(page);
      /** Share of pixels that are not quite the background. */
      const covered = () =>
        page.evaluate(async () => {
          const { pixels } = await /** @type {any} */ (window).marchingParticles.pixels(320, 240);
          let n = 0;
          for (let i = 0; i < pixels.length; i += 4) if (Math.abs(pixels[i] - pixels[0]) > 3) n += 1;
          return (4 * n) / pixels.length;
        });
      const bare = await covered();
      await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ ghost: true }));
      await expect.poll(async () => (await status(page)).mesh !== null).toBe(true);
      await atRest(page);
      const above = await covered();
      expect(above).toBeGreaterThan(1.2 * bare);
      await cut(page, { normal: [0, 1, 0], offset: 0 });
      expect(await covered()).toBeLessThan(0.6 * above);
      expect(errors).toEqual([]);
    });
  }
};
