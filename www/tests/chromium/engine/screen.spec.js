/**
 * A screen that changes under the picture: resized window, another pixel ratio, a size beyond the device. What a hidden tab
 * does is tested without a browser.
 */
import { expect, test } from '@playwright/test';
import { counts, expectCanvasShown, expectSurface, open, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** Sizes of the canvas: its pixels, and what it covers of the page. @param {Page} page */
const canvas = (page) =>
  page.evaluate(() => {
    const element = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
    const { width, height } = element.getBoundingClientRect();
    return { width: element.width, height: element.height, cssWidth: width, cssHeight: height };
  });

test('a screen that changes is drawn as it is', { tag: '@all' }, async ({ page }) => {
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
  await test.step('a window in motion ends with a canvas of its size', async () => {
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

  await test.step('a window wider than the device can draw is drawn smaller, in proportion', async () => {
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

  await test.step('a window taken to a screen of another pixel ratio is drawn in its pixels', async () => {
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
});
