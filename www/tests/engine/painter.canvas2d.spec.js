/** The page in a browser without any graphics API: dots on a 2-D canvas; everything else works as ever. */
import { expect, test } from '@playwright/test';
import { expectCanvasShown, expectInside, expectSurface, open, spots, status } from './browser.js';

test('the surface is painted without a graphics card', async ({ page }) => {
  const { errors } = await open(page);
  expect((await status(page)).backend).toBe('canvas2d');
  await expectSurface(page);
  await expectCanvasShown(page);
  expect(errors).toEqual([]);
});

test('discs seen from behind are darker and greyer, on a light and on a dark ground', async ({ page }) => {
  await open(page);
  await expectInside(page, 'discs');
});

test('figures and files are there as well', async ({ page }) => {
  await open(page);
  const out = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      return {
        six: p.report().quality.six,
        ply: (await p.engine.exportFile('ply')).size,
        png: (await p.engine.savePng({ width: 200, height: 150 })).type,
        picked: p.engine.pick(
          ...(() => {
            p.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
            const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
            return [host.clientWidth / 2, host.clientHeight / 2];
          })(),
        ),
      };
    })
  );
  expect(out.six).toBeGreaterThan(0.85);
  expect(out.ply).toBeGreaterThan(30_000);
  expect(out.png).toBe('image/png');
  expect(out.picked).not.toBe(null);
});

test('the points of a model are painted, too', async ({ page }) => {
  await open(page);
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({
      surface: 'bunny',
      settings: { radius_share: 0.015 },
      view: { colour: 'plain' },
    }),
  );
  const dotted = await spots(page);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ points: false }));
  expect(dotted.black).toBeGreaterThan((await spots(page)).black + 100);
});
