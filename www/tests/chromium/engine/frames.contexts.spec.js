/**
 * Many pages on one page: a browser keeps some WebGL contexts alive, and takes the oldest one away for the next. They are 16
 * at most; here they are {@link CONTEXTS}, by an option of the browser, so that it takes fewer pages.
 */
import { expect, test } from '@playwright/test';
import { askingFor, link } from './browser.js';

/** As in `playwright.config.js`. */
const CONTEXTS = 4;
const FRAMES = CONTEXTS + 2;
/** Height of a frame: two of them are in view. */
const HEIGHT = 170;

test('of more frames than contexts those in view have a live context, and the others dots in its place', {
  tag: '@all',
}, async ({ page }) => {
  // Six pages open at once.
  await page.setViewportSize({ width: 320, height: 2 * HEIGHT });
  const address = askingFor(`./${link({ settings: { radius_share: 0.03, relax_steps: 0 } })}`, 'webgl2');
  const frame = `<iframe src="${address}" style="display:block;border:0;width:300px;height:${HEIGHT}px"></iframe>`;
  await page.route('**/frames.html', (route) =>
    route.fulfill({
      contentType: 'text/html',
      body: `<!doctype html><body style="margin:0">${frame.repeat(FRAMES)}</body>`,
    }),
  );
  await page.goto('/frames.html');
  await expect.poll(() => page.frames().length).toBe(FRAMES + 1);
  const frames = await Promise.all((await page.locator('iframe').elementHandles()).map((each) => each.contentFrame()));
  const kinds = () =>
    Promise.all(
      frames.map(
        (frame) =>
          frame?.evaluate(() => /** @type {any} */ (window).marchingParticles?.status().backend ?? 'none') ?? '',
      ),
    );
  /** How many pixels of a canvas are unlike its corner. @param {number} k */
  const inked = (k) =>
    frames[k]?.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const { pixels } = await p.pixels(80, 60);
      let count = 0;
      for (let i = 0; i < pixels.length; i += 4) if (Math.abs(pixels[i] - pixels[0]) > 24) count += 1;
      return count;
    });
  for (const frame of frames) {
    await frame?.waitForFunction(() => 'marchingParticles' in window);
    await frame?.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  }
  // A context that was taken from a frame in view is opened again, and taken from one that is not.
  await expect.poll(async () => (await kinds()).slice(0, 2)).toEqual(['webgl2', 'webgl2']);
  await expect.poll(async () => (await kinds()).filter((kind) => kind === 'canvas2d').length).toBeGreaterThan(0);
  const resting = (await kinds()).lastIndexOf('canvas2d');
  expect(resting).toBeGreaterThan(1);
  expect(await inked(resting)).toBeGreaterThan(200);
  await page.evaluate((top) => scrollTo(0, top), resting * HEIGHT);
  await expect.poll(async () => (await kinds())[resting]).toBe('webgl2');
  expect(await inked(resting)).toBeGreaterThan(200);
  const notices = await Promise.all(
    frames.map((frame) =>
      frame?.evaluate(() => /** @type {any} */ (window).marchingParticles.status().notice?.id ?? null),
    ),
  );
  // No frame was given a kind of picture that it need not have.
  expect(notices).not.toContain('fallback');
});
