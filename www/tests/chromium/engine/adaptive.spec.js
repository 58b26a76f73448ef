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
const camera = { target: [0, 0, 0], distance: 6, yaw: Math.PI / 2, pitch: 0, fit: false };

test('an adaptive run draws discs of different size: small where the surface bends', { tag: '@all' }, async ({
  page,
}) => {
  await open(page);
  // Seen from its side: the discs of its belly, and those on the way to its tips.
  const seen = async (/** @type {object} */ settings) => {
    const report = await set(page, { ...spindle, settings, view: { colour: 'plain', size: 0.6, body: false, camera } });
    expect(report.stop_reason).toBe('complete');
    const { found } = await spots(page);
    const median = (/** @type {number[]} */ areas) => areas[Math.floor(areas.length / 2)];
    // Smaller spots are slivers of discs that others hide.
    const areas = (/** @type {number} */ from, /** @type {number} */ to) =>
      median(found.filter(({ off, area }) => off >= from && off < to && area > 9).map(({ area }) => area));
    return areas(0, 50) / areas(230, 270);
  };
  const many = await seen(adaptive);
  const ratio = await page.evaluate(() => {
    const { radii } = /** @type {any} */ (window).marchingParticles.particles();
    return Math.max(...radii) / Math.min(...radii);
  });
  expect(ratio).toBeGreaterThan(1.8);
  const uniform = { sampling: 'uniform', radius_share: 0.013 };
  const one = await seen(uniform);
  expect(many / one).toBeGreaterThan(2);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ colour: 'curvature' }));
  await expectCanvasShown(page);
});
