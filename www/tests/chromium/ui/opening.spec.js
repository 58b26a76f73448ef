/** The first picture: the surface grows from its seed before the eye. */
import { expect, test } from '@playwright/test';
import { atRest, open, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** Cosine of the angle at which the seed is seen, in every frame of the opening. @param {Page} page */
const watch = (page) =>
  page.addInitScript(() => {
    const seen = /** @type {number[]} */ ([]);
    const hashes = /** @type {string[]} */ ([]);
    Object.assign(window, { seen, hashes });
    const { replaceState } = history;
    history.replaceState = (data, unused, url) => {
      if (String(url).includes('#')) hashes.push(String(url));
      replaceState.call(history, data, unused, url);
    };
    const look = () => {
      const p = /** @type {any} */ (window).marchingParticles;
      if (p?.engine.reveal.value && p.engine.columns.count > 0) {
        const { direction } = p.engine.rayThrough(innerWidth / 2, innerHeight / 2);
        const { normals } = p.engine.columns;
        seen.push(-(direction[0] * normals[0] + direction[1] * normals[1] + direction[2] * normals[2]));
      }
      requestAnimationFrame(look);
    };
    look();
  });

test('faces the seed while the surface grows, then turns to the usual view', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await watch(page);
  const { clean } = await open(page);
  const seen = await page.evaluate(() => /** @type {any} */ (window).seen);
  expect(seen.length).toBeGreaterThan(1);
  expect(seen[0]).toBeGreaterThan(0.4);
  await expect
    .poll(() =>
      page.evaluate(() => {
        const { engine } = /** @type {any} */ (window).marchingParticles;
        const { direction } = engine.rayThrough(innerWidth / 2, innerHeight / 2);
        return direction[2];
      }),
    )
    .toBeLessThan(-0.3);
  await atRest(page);
  const { yaw, pitch, distance } = (await state(page)).view.camera;
  expect([yaw, pitch]).toEqual([0.62, 0.42]);
  // As large as a fit makes it.
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.fit());
  await atRest(page);
  expect((await state(page)).view.camera.distance).toBeCloseTo(distance, 4);
  // The address never holds a view that nobody chose: it is written half a second after a change.
  await page.waitForTimeout(700);
  expect(new URL(page.url()).hash).toBe('');
  expect(await page.evaluate(() => /** @type {any} */ (window).hashes)).toEqual([]);
  await clean();
});

test('the legend has the colours of the particles from the first frame that shows some', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await page.addInitScript(() => {
    const legends = /** @type {string[]} */ ([]);
    Object.assign(window, { legends });
    const look = () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const scale = document.querySelector('.scale');
      if (p?.engine.reveal.value?.particles > 0 && scale)
        legends.push(scale.checkVisibility() ? (scale.textContent ?? '') : '');
      requestAnimationFrame(look);
    };
    look();
  });
  const { clean } = await open(page);
  const legends = await page.evaluate(() => /** @type {any} */ (window).legends);
  expect(legends.length).toBeGreaterThan(5);
  expect(legends.filter((/** @type {string} */ text) => text.includes('everywhere'))).toEqual([]);
  expect(legends.at(-1)).toContain('rings around the seed');
  expect(legends[Math.floor(legends.length / 2)]).toBe(legends.at(-1));
  await clean();
});

test('stays as it is where motion is reduced', async ({ page }) => {
  const { clean } = await open(page);
  const { yaw, pitch } = (await state(page)).view.camera;
  expect([yaw, pitch]).toEqual([0.62, 0.42]);
  await clean();
});
