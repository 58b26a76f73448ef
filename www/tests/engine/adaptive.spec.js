/** The discs of an adaptive run. */
import { expect, test } from '@playwright/test';
import { expectCanvasShown, open, spots } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {object} patch @returns {Promise<any>} */
const set = (page, patch) => page.evaluate((p) => /** @type {any} */ (window).marchingParticles.set(p), patch);

/** Some 900 particles, of which the largest are several times the smallest. */
const adaptive = { sampling: 'adaptive', chord_error: 6e-4, radius_min_share: 0.002, radius_max_share: 0.05 };
/** A spindle: sharp at its ends, nearly straight between. */
const spindle = { formula: 'x^2/4 + 6 y^2 + 6 z^2 = 1', bounds: { min: [-2.2, -0.6, -0.6], max: [2.2, 0.6, 0.6] } };
const camera = (/** @type {number} */ yaw) => ({ target: [0, 0, 0], distance: 6, yaw, pitch: 0, fit: false });

test('an adaptive run draws discs of different size: small where the surface bends', async ({ page }) => {
  await open(page);
  // Seen on its belly and on its tip, by the largest disc in the middle of the picture.
  const seen = async (/** @type {object} */ settings, /** @type {number} */ yaw) => {
    const report = await set(page, { ...spindle, settings, view: { colour: 'plain', size: 0.6, camera: camera(yaw) } });
    expect(report.stop_reason).toBe('complete');
    return (await spots(page)).found.filter(({ off }) => off < 25)[0].area;
  };
  const many = (await seen(adaptive, Math.PI / 2)) / (await seen(adaptive, 0));
  const ratio = await page.evaluate(() => {
    const { radii } = /** @type {any} */ (window).marchingParticles.particles();
    return Math.max(...radii) / Math.min(...radii);
  });
  expect(ratio).toBeGreaterThan(1.8);
  const uniform = { sampling: 'uniform', radius_share: 0.013 };
  const one = (await seen(uniform, Math.PI / 2)) / (await seen(uniform, 0));
  expect(many / one).toBeGreaterThan(2);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ colour: 'curvature' }));
  await expectCanvasShown(page);
});
