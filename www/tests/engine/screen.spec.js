/**
 * A screen that changes under the picture: hidden tab, resized window, another pixel ratio, a size beyond the device.
 */
import { expect, test } from '@playwright/test';
import { coarse, counts, expectCanvasShown, expectSurface, open, picture, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** Sizes of the canvas: its pixels, and what it covers of the page. @param {Page} page */
const canvas = (page) =>
  page.evaluate(() => {
    const element = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
    const { width, height } = element.getBoundingClientRect();
    return { width: element.width, height: element.height, cssWidth: width, cssHeight: height };
  });

/** Makes the page believe that its tab is hidden, or shown again; runs in the page. @param {boolean} hidden */
function believe(hidden) {
  Object.defineProperty(document, 'hidden', { configurable: true, get: () => hidden });
  Object.defineProperty(document, 'visibilityState', {
    configurable: true,
    get: () => (hidden ? 'hidden' : 'visible'),
  });
  document.dispatchEvent(new Event('visibilitychange'));
}

/** @param {Page} page @param {boolean} hidden */
const hide = (page, hidden) => page.evaluate(believe, hidden);

test('a hidden tab draws nothing and samples on; shown again it has the new surface', async ({ page }) => {
  await open(page);
  const before = await picture(page);
  await hide(page, true);
  await page.waitForTimeout(200);
  const { frames } = await counts(page);
  const report = /** @type {any} */ (
    await page.evaluate(
      (settings) => /** @type {any} */ (window).marchingParticles.set({ surface: 'torus', settings }),
      coarse.settings,
    )
  );
  expect(report.stop_reason).toBe('complete');
  expect(report.quality.euler).toBe(0);
  await page.waitForTimeout(300);
  expect((await counts(page)).frames).toBe(frames);
  await hide(page, false);
  await expect.poll(async () => (await counts(page)).frames).toBeGreaterThan(frames);
  await expectSurface(page);
  await expectCanvasShown(page);
  expect((await picture(page)).drawn).not.toBe(before.drawn);
});

test('a tab hidden while the surface grows is not stuck half-way', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await open(page);
  // Hidden by the page itself: from here it could come after the last level.
  await page.evaluate(`new Promise((hidden) => {
    const { engine } = window.marchingParticles;
    engine.run();
    const off = engine.reveal.subscribe((reveal) => {
      if (!reveal) return;
      setTimeout(() => {
        off();
        (${believe})(true);
        hidden();
      });
    });
  })`);
  await expect.poll(async () => (await status(page)).busy).toBe(false);
  await hide(page, false);
  await expect
    .poll(() => page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.reveal.value))
    .toBe(null);
  await expectSurface(page);
  await expectCanvasShown(page);
});

test('a window in motion ends with a canvas of its size', async ({ page }) => {
  await open(page);
  for (const [width, height] of [
    [700, 300],
    [320, 640],
    [900, 700],
    [480, 360],
  ]) {
    await page.setViewportSize({ width, height });
    await expect
      .poll(async () => {
        const now = await canvas(page);
        return [now.cssWidth, now.cssHeight, now.width, now.height];
      })
      .toEqual([width, height, width, height]);
  }
  await expectSurface(page);
  await expectCanvasShown(page);
});

test('a window taken to a screen of another pixel ratio is drawn in its pixels', async ({ page }) => {
  // The emulated screen changes its pixels but tells no media query: the test does, as a real monitor would.
  await page.addInitScript(() => {
    const ask = window.matchMedia.bind(window);
    /** @type {any} */ (window).monitors = [];
    window.matchMedia = (query) => {
      const list = ask(query);
      if (query.startsWith('(resolution')) /** @type {any} */ (window).monitors.push(list);
      return list;
    };
  });
  await open(page);
  const session = await page.context().newCDPSession(page);
  for (const [ratio, drawn] of [
    [2, 2],
    [1.5, 1.5],
    [4, 2],
    [1, 1],
  ]) {
    await session.send('Emulation.setDeviceMetricsOverride', {
      width: 480,
      height: 360,
      deviceScaleFactor: ratio,
      mobile: false,
    });
    await page.evaluate(() => /** @type {any} */ (window).monitors.at(-1).dispatchEvent(new Event('change')));
    await expect.poll(async () => (await canvas(page)).width).toBe(480 * drawn);
    expect((await canvas(page)).height).toBe(360 * drawn);
    await expectSurface(page);
  }
  await expectCanvasShown(page);
  expect((await counts(page)).opened).toBe(1);
});

test('a window wider than the device can draw is drawn smaller, in proportion', async ({ page }) => {
  await open(page);
  await page.setViewportSize({ width: 9000, height: 300 });
  await expect.poll(async () => (await canvas(page)).cssWidth).toBe(9000);
  // The page has its size before the canvas has one of its own.
  await expect
    .poll(async () => {
      const { width, height } = await canvas(page);
      return Math.round(width / height);
    })
    .toBe(30);
  const { width } = await canvas(page);
  expect(width).toBeLessThanOrEqual(8192);
  expect(width).toBeGreaterThan(4000);
  await page.setViewportSize({ width: 480, height: 360 });
  await expect.poll(async () => (await canvas(page)).width).toBe(480);
  await expectSurface(page);
  expect((await status(page)).notice).toBe(null);
});
