/** Adaptive runs and the colours that belong to them: radius, curvature and component. */
import { expect, test } from '@playwright/test';
import { expectCanvasShown, open, picture, spots, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {object} patch @returns {Promise<any>} */
const set = (page, patch) => page.evaluate((p) => /** @type {any} */ (window).marchingParticles.set(p), patch);

/** @param {Page} page @returns {Promise<any>} */
const legend = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.legend.value);

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
});

test('radius and curvature colour the surface by a ramp that follows it', async ({ page }) => {
  await open(page);
  await set(page, { ...spindle, settings: adaptive, view: { colour: 'radius' } });
  const radius = await legend(page);
  expect(radius).toMatchObject({ kind: 'sequential', pending: false });
  const [low, high] = radius.range;
  expect(high / low).toBeGreaterThan(1.8);
  expect((await picture(page)).hues).toBeGreaterThanOrEqual(4);

  // Dented like a peanut: it bulges at the ends and is hollow in the middle.
  const peanut = {
    formula: '(x^2 + y^2 + z^2 + 1)^2 - 4 x^2 = 1.2',
    bounds: { min: [-1.8, -1, -1], max: [1.8, 1, 1] },
  };
  await set(page, { ...peanut, settings: { radius_share: 0.012 }, view: { colour: 'curvature' } });
  await expect.poll(async () => (await legend(page)).pending).toBe(false);
  const bent = await legend(page);
  expect(bent.kind).toBe('diverging');
  expect(bent.range[0]).toBe(-bent.range[1]);
  expect(bent.range[1]).toBeGreaterThan(0.5);
  const curvature = await page.evaluate(() => [.../** @type {any} */ (window).marchingParticles.particles().curvature]);
  for (let i = 0; i < curvature.length; i += 2) expect(curvature[i]).toBeGreaterThanOrEqual(curvature[i + 1]);
  await expectCanvasShown(page);
});

test('the curvature of a sphere is that of a sphere, also when it is asked for after the run', async ({ page }) => {
  await open(page);
  await set(page, { formula: 'x^2 + y^2 + z^2 = 0.25', settings: { radius_share: 0.02 }, view: { colour: 'level' } });
  expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().curvature)).toBe(null);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ colour: 'curvature' }));
  await expect.poll(async () => (await legend(page)).pending).toBe(false);
  const curvature = await page.evaluate(() => [.../** @type {any} */ (window).marchingParticles.particles().curvature]);
  for (const k of curvature) expect(k).toBeCloseTo(2, 3);
});

test('components have colours of their own, with their counts', async ({ page }) => {
  await open(page);
  const three = 'min((x-1.2)^2 + y^2 + z^2 - 0.3, (x+1.2)^2 + y^2 + z^2 - 0.2, x^2 + (y-1.2)^2 + z^2 - 0.1)';
  const report = await set(page, {
    formula: three,
    bounds: { min: [-2, -1, -1], max: [2, 2, 1] },
    settings: { radius_share: 0.012 },
    view: { colour: 'component' },
  });
  expect(report.components).toBe(3);
  const { entries } = await legend(page);
  const counts = entries.map((/** @type {{count: number}} */ e) => e.count);
  expect(counts).toHaveLength(3);
  expect(counts).toEqual([...counts].sort((p, q) => q - p));
  expect(counts.reduce((/** @type {number} */ sum, /** @type {number} */ n) => sum + n, 0)).toBe(report.count);
  expect((await picture(page)).hues).toBeGreaterThanOrEqual(2);
  const { component, positions } = await page.evaluate(() => {
    const { component: labels, positions: p } = /** @type {any} */ (window).marchingParticles.particles();
    return { component: [...labels], positions: [...p] };
  });
  for (let i = 0; i < component.length; i += 1) {
    expect(component[i]).toBe(positions[3 * i + 1] > 0.7 ? 2 : positions[3 * i] > 0 ? 0 : 1);
  }
});

test('a setting of an adaptive run dragged at 60 Hz ends at its last value', async ({ page }) => {
  await open(page);
  await set(page, { settings: adaptive });
  const end = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      for (let k = 0; k < 60; k += 1) {
        p.engine.setSetting('chord_error', 6e-4 - 9e-6 * k, { live: true });
        await new Promise((resolve) => setTimeout(resolve, 16));
      }
      p.engine.setSetting('chord_error', 6e-5);
      await new Promise((resolve) => {
        const off = p.engine.report.subscribe((/** @type {any} */ report) => {
          if (report) setTimeout(() => resolve(off()));
        });
      });
      return { drag: p.engine.lastDrag.value, report: p.report(), setting: p.state.settings.chord_error };
    })
  );
  expect(end.setting).toBe(6e-5);
  expect(end.drag.shown).toBeGreaterThan(0);
  const whole = await set(page, { settings: { ...adaptive, chord_error: 6e-5 } });
  expect(end.report.digest).toBe(whole.digest);
  expect((await status(page)).notice).toBe(null);
});

test('a link holds every setting of an adaptive run', async ({ page }) => {
  await open(page);
  const settings = {
    ...adaptive,
    radius_law: 'sum_of_curvatures',
    curvature_scale: 0.11,
    grading: 0.3,
  };
  const before = await set(page, { ...spindle, settings, view: { colour: 'radius' } });
  const shared = String(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link()));
  await page.goto('about:blank');
  await open(page, `/${new URL(shared).hash}`);
  const state = /** @type {any} */ (await page.evaluate(() => /** @type {any} */ (window).marchingParticles.state));
  expect(state.settings).toEqual(settings);
  expect(state.view.colour).toBe('radius');
  expect(
    /** @type {any} */ (await page.evaluate(() => /** @type {any} */ (window).marchingParticles.report())).digest,
  ).toBe(before.digest);
});
