/** A graphics card that takes long for its frames: it is slow by the clock of the page, whatever the machine. */
import { expect, test } from '@playwright/test';
import { atRest, expectSurface, open, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** Has frames come no sooner than this one after the other, and keeps the width of the canvas in each. @param {Page} page */
const slowDown = (page, frameMs = 100) =>
  page.addInitScript((ms) => {
    const widths = /** @type {number[]} */ ([]);
    Object.assign(window, { widths });
    window.requestAnimationFrame = (draw) => {
      const timer = setTimeout(() => {
        draw(performance.now());
        const canvas = /** @type {HTMLCanvasElement | null} */ (document.querySelector('#canvas-host canvas'));
        if (canvas) widths.push(canvas.width);
      }, ms);
      return Number(timer);
    };
    window.cancelAnimationFrame = (handle) => clearTimeout(handle);
  }, frameMs);

/** Widths of the canvas since the last call. @param {Page} page @returns {Promise<number[]>} */
const widths = (page) => page.evaluate(() => /** @type {any} */ (window).widths.splice(0));

test('it draws what moves with half the pixels of a side, and what stands still with all', { tag: '@all' }, async ({
  page,
}) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await slowDown(page);
  const { errors } = await open(page);
  await atRest(page);
  // The growth of the levels is what it is judged by.
  const grown = await widths(page);
  expect(grown).toContain(240);
  expect(grown.at(-1)).toBe(480);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.lookFrom('top'));
  await atRest(page);
  const turned = await widths(page);
  expect(turned).toContain(240);
  expect(turned.at(-1)).toBe(480);
  await expectSurface(page);
  expect((await status(page)).notice).toBe(null);
  expect(errors).toEqual([]);
});
