/** A machine without a graphics card, on which a program draws WebGL2: the page asks for nothing, and the painter stays. */
import { expect, test } from '@playwright/test';
import { atRest, counts, expectCanvasShown, expectSurface, open, status } from './browser.js';

const PAINTED = { asks: null, drawnBy: 'canvas2d' };

test('the painter that stands in stays, is said in one chip, and the renderers are not fetched', {
  tag: '@all',
}, async ({ page }) => {
  /** @type {string[]} */
  const renderers = [];
  page.on('request', (request) => {
    if (/render/.test(request.url())) renderers.push(request.url());
  });
  const { errors } = await open(page, './', PAINTED);
  await expectSurface(page);
  await expectCanvasShown(page);
  await expect(page.getByText('No graphics card')).toBeAttached();
  expect(renderers).toEqual([]);
  expect((await status(page)).notice).toBe(null);
  expect(errors).toEqual([]);
});

test('the page is ready within a number of frames and of painted pixels, and then draws nothing', async ({ page }) => {
  await open(page, './', PAINTED);
  const size = 480 * 360;
  const { frames, work, opened } = await counts(page);
  expect(opened).toBe(1);
  // A few while the particles come, and the whole picture, of four samples.
  expect(frames).toBeLessThan(40);
  expect(work).toBeLessThan(40 * size);
  await page.waitForTimeout(700);
  expect((await counts(page)).frames).toBe(frames);
});

test('a surface that grows is painted with little work a frame', { tag: '@all' }, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await open(page, './', PAINTED);
  const size = 480 * 360;
  const { frames, work, opened } = await counts(page);
  expect(opened).toBe(1);
  // The levels take 2.6 s, at 60 frames a second or fewer.
  expect(frames).toBeGreaterThan(15);
  expect(frames).toBeLessThan(240);
  expect(work / frames).toBeLessThan(2 * size);
});

test('what moves is painted once a frame, what stands still in four samples', { tag: '@all' }, async ({ page }) => {
  await open(page, undefined, PAINTED);
  await atRest(page);
  /** Work of a frame after the camera has turned, and of all until the picture stands still. */
  const [moving, all] = await page.evaluate(async () => {
    const { engine, debug } = /** @type {any} */ (window).marchingParticles;
    const before = debug.counts();
    engine.orbit(0.1, 0);
    while (debug.counts().frames === before.frames) await new Promise(requestAnimationFrame);
    const { work } = debug.counts();
    await debug.still();
    return [work - before.work, debug.counts().work - before.work];
  });
  expect(moving).toBeGreaterThan(0);
  expect(all - moving).toBeGreaterThan(2 * moving);
});

test('a mesh and spheres are painted, too', { tag: '@all' }, async ({ page }) => {
  const { errors } = await open(page, undefined, PAINTED);
  for (const draw of ['spheres', 'mesh']) {
    await page.evaluate((d) => /** @type {any} */ (window).marchingParticles.engine.setView({ draw: d }), draw);
    await expect.poll(async () => (await status(page)).mesh !== null).toBe(draw === 'mesh');
    await atRest(page);
    await expectSurface(page);
    await expectCanvasShown(page);
  }
  expect((await status(page)).backend).toBe('canvas2d');
  expect(errors).toEqual([]);
});

test.describe('on a screen with two pixels to one', () => {
  test.use({ deviceScaleFactor: 2 });
  test('a picture that stands still is painted in its pixels', { tag: '@all' }, async ({ page }) => {
    await open(page, undefined, PAINTED);
    const widths = () =>
      page.evaluate(() => {
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
        return [canvas.width, canvas.getBoundingClientRect().width];
      });
    await expect.poll(widths).toEqual([960, 480]);
  });
});
