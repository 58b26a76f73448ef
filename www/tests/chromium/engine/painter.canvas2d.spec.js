/** The page in a browser without any graphics API: dots on a 2-D canvas. What is in them is tested without a browser. */
import { expect, test } from '@playwright/test';
import { expectCanvasShown, expectSurface, open } from './browser.js';

test('the surface is painted without a graphics card, and saved', async ({ page }) => {
  const { errors } = await open(page, undefined, { asks: null, drawnBy: 'canvas2d' });
  await expectSurface(page);
  await expectCanvasShown(page);
  const png = await page.evaluate(
    async () => (await /** @type {any} */ (window).marchingParticles.engine.savePng({ width: 200, height: 150 })).type,
  );
  expect(png).toBe('image/png');
  expect(errors).toEqual([]);
});
