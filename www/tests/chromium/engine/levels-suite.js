/** The generation levels in the picture: what is hidden and what is muted. */
import { expect, test } from '@playwright/test';
import { counts, open, picture } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** Shows a level. @param {Page} page @param {number | null} level */
const show = (page, level) =>
  page.evaluate((k) => /** @type {any} */ (window).marchingParticles.engine.setView({ level: k }), level);

/**
 * Faces the seed, so that the first levels are in front, and holds the camera, which would frame them. Near to it the
 * seed is in the middle.
 * @param {Page} page @param {boolean} isNear
 */
const faceSeed = (page, isNear) =>
  page.evaluate((near) => {
    const p = /** @type {any} */ (window).marchingParticles;
    const [x, y, z] = p.particles().normals;
    const angles = { yaw: Math.atan2(y, x), pitch: Math.asin(Math.max(-1, Math.min(1, z))), fit: false };
    const target = near ? [...p.particles().positions.subarray(0, 3)] : p.state.view.camera.target;
    p.engine.setView({ size: near ? 1.5 : p.state.view.size, camera: { ...p.state.view.camera, ...angles, target } });
  }, isNear);

export const suite = () =>
  test('a level hides the later ones and mutes the earlier ones, also after the device was lost', {
    tag: '@all',
  }, async ({ page }) => {
    await open(page);
    await faceSeed(page, false);
    const drawn = [];
    for (const level of [0, 3, 8, null]) {
      await show(page, level);
      // The surface to come is grey.
      drawn.push((await picture(page)).coloured);
    }
    for (let k = 1; k < drawn.length; k += 1) expect(drawn[k]).toBeGreaterThan(1.5 * drawn[k - 1]);
    await show(page, 3);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
    await expect.poll(async () => (await counts(page)).opened).toBe(2);
    expect((await picture(page)).coloured).toBeCloseTo(drawn[1], 2);
    // The seed is pure in its own level, paler in the next.
    await faceSeed(page, true);
    const shades = [];
    for (const level of [0, 1]) {
      await show(page, level);
      const { middle, corner } = await picture(page);
      shades.push(Math.hypot(...[0, 1, 2].map((k) => middle[k] - corner[k])));
    }
    expect(shades[1]).toBeLessThan(0.8 * shades[0]);
    expect(shades[1]).toBeGreaterThan(0.2 * shades[0]);
  });
