/** The points of a model in the picture. */
import { expect, test } from '@playwright/test';
import { expectCanvasShown, expectSurface, open, spots } from './browser.js';

const bunny = { surface: 'bunny', settings: { radius_share: 0.015 } };

test('the points of a model stay on it when it turns, and keep their size when it comes nearer', {
  tag: '@all',
}, async ({ page }) => {
  const { errors, strangers } = await open(page);
  const set = (/** @type {object} */ patch) =>
    page.evaluate((p) => /** @type {any} */ (window).marchingParticles.set(p), patch);
  await set(bunny);
  await expectSurface(page);
  await expectCanvasShown(page);
  await set({ view: { size: 0.2, colour: 'plain', theme: 'dark' } });
  // White dots on a dark ground: with discs this small nearly all the white is theirs.
  const near = async (/** @type {number} */ factor) => {
    await page.evaluate((by) => /** @type {any} */ (window).marchingParticles.engine.zoom(by), factor);
    await page.waitForTimeout(100);
    return (await spots(page)).white;
  };
  const [home, nearer, back] = [await near(1), await near(1.6), await near(1 / 1.6)];
  expect(home).toBeGreaterThan(300);
  expect(nearer / home).toBeGreaterThan(0.4);
  expect(nearer / home).toBeLessThan(1.6);
  expect(back / home).toBeCloseTo(1, 1);
  await set({ view: { points: false } });
  expect((await spots(page)).white).toBeLessThan(home / 2);
  expect(strangers).toEqual([]);
  expect(errors).toEqual([]);
});
