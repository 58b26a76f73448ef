/** A graphics card that takes long for its frames, by the clock of the page, which stands still between them. */
import { expect, test } from '@playwright/test';
import { atRest, expectSurface, open, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/**
 * Has every frame take so long by the page's clock, however long it takes in truth, and keeps the width of the canvas
 * in each.
 * @param {Page} page
 */
const slowDown = (page, frameMs = 100) =>
  page.addInitScript((ms) => {
    const widths = /** @type {number[]} */ ([]);
    Object.assign(window, { widths });
    /** @type {Map<number, FrameRequestCallback>} */
    const asked = new Map();
    let [nowMs, last, isDue] = [0, 0, false];
    performance.now = () => nowMs;
    const frame = () => {
      isDue = false;
      nowMs += ms;
      const all = [...asked.values()];
      asked.clear();
      for (const draw of all) draw(nowMs);
      const canvas = /** @type {HTMLCanvasElement | null} */ (document.querySelector('#canvas-host canvas'));
      if (canvas) widths.push(canvas.width);
    };
    window.requestAnimationFrame = (draw) => {
      last += 1;
      asked.set(last, draw);
      if (!isDue) setTimeout(frame);
      isDue = true;
      return last;
    };
    window.cancelAnimationFrame = (handle) => asked.delete(handle);
  }, frameMs);

/** Widths of the canvas since the last call. @param {Page} page @returns {Promise<number[]>} */
const widths = (page) => page.evaluate(() => /** @type {any} */ (window).widths.splice(0));

/** Turns the picture, and returns the widths of the canvas meanwhile. @param {Page} page @param {string} side */
async function turned(page, side) {
  await widths(page);
  await page.evaluate((to) => /** @type {any} */ (window).marchingParticles.engine.lookFrom(to), side);
  await atRest(page);
  return widths(page);
}

test('it draws what moves with half the pixels of a side, and what stands still with all', { tag: '@all' }, async ({
  page,
}) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await slowDown(page);
  // On a first visit the first slider moves by itself.
  await page.addInitScript(() => localStorage.setItem('marching-particles.invited', 'on'));
  const { errors } = await open(page);
  await atRest(page);
  // By these it is judged: the levels may have grown before it was open, on the canvas that stands in for it.
  for (const side of ['top', 'right', 'front']) expect((await turned(page, side)).at(-1), side).toBe(480);
  const seen = await turned(page, 'top');
  expect(seen).toContain(240);
  expect(seen.at(-1)).toBe(480);
  await expectSurface(page);
  expect((await status(page)).notice).toBe(null);
  expect(errors).toEqual([]);
});
