/** A press on a figure of the spacing shows the place in the picture. */
import { expect, test } from '@playwright/test';
import { afresh, atRest, open, openFigures, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page */
const places = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.report().places);

test('places that are pointed out', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('the closest pair, the crowded pairs and the largest hole are brought before the camera', async () => {
    await atRest(page);
    await openFigures(page);
    const report = page.locator('#panel-report');
    const { pairs, holes } = await places(page);
    const before = (await state(page)).view.camera;

    await report.getByRole('button', { name: /^Closest pair .*show it/ }).click();
    await atRest(page);
    await expect(page.locator('.marks .marked')).toHaveCount(3);
    const look = () =>
      page.evaluate((pair) => {
        const p = /** @type {any} */ (window).marchingParticles;
        const { positions, normals } = p.particles();
        const at = (/** @type {number} */ i) => Array.from(positions.subarray(3 * i, 3 * i + 3));
        const { yaw, pitch } = p.state.view.camera;
        const eye = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
        const normal = normals.subarray(3 * pair.particles[0], 3 * pair.particles[0] + 3);
        const spots = pair.particles.map((/** @type {number} */ i) => p.engine.project(at(i)));
        const target = p.engine.project(p.state.view.camera.target);
        return { facing: eye.reduce((sum, c, k) => sum + c * normal[k], 0), spots, target };
      }, pairs[0]);
    await expect.poll(async () => (await look()).facing).toBeGreaterThan(0.99);
    const seen = await look();
    expect(seen.target.x).toBeCloseTo((seen.spots[0].x + seen.spots[1].x) / 2, 0);
    expect((await state(page)).view.camera.distance).toBeLessThan(before.distance / 2);
    await expect(page.locator('.marks text')).toContainText(pairs[0].ratio.toFixed(3));

    // A press by key shows the next one, where there are several.
    const crowded = report.getByRole('button', { name: /^Pairs nearer than 0\.75 \d+, show it/ });
    await expect(crowded).toHaveText(
      String((await page.evaluate(() => /** @type {any} */ (window).marchingParticles.report())).quality.crowded),
    );
    await crowded.focus();
    await page.keyboard.press('Enter');
    await expect(page.locator('.marks text')).toContainText(pairs.length > 1 ? `2 of ${pairs.length}` : '0.');

    await report.getByRole('button', { name: /^Largest hole .*show it/ }).click();
    await atRest(page);
    await expect(page.locator('.marks .marked')).toHaveCount(1);
    const hole = await page.evaluate((place) => {
      const spot = /** @type {any} */ (window).marchingParticles.engine.project(place.position);
      const ring = /** @type {Element} */ (document.querySelector('.marks .marked'));
      return {
        x: spot.x - Number(ring.getAttribute('cx')),
        radius: place.radius / spot.perPx - Number(ring.getAttribute('r')),
      };
    }, holes[0]);
    expect(Math.abs(hole.x) + Math.abs(hole.radius)).toBeLessThan(1);
    expect((await scan(page)).violations).toEqual([]);

    await page.keyboard.press('Escape');
    await page.keyboard.press('Escape');
    await expect(page.locator('.marks .marked')).toHaveCount(0);
  });

  await test.step('a mark goes with the run that it belongs to', async () => {
    await afresh(page, { width: 1440, height: 900 });
    const hole = page.getByRole('button', { name: /^Largest hole .*show it/ });
    await hole.click();
    await expect(page.locator('.marks .marked')).toHaveCount(1);
    const before = await hole.getAttribute('aria-label');
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ parameters: { a: 1.3 } }));
    await expect(page.locator('.marks .marked')).toHaveCount(0);
    // The figure is another one, and a key presses it again.
    await expect(hole).not.toHaveAttribute('aria-label', before ?? '');
    await expect(hole).toBeFocused();
    await page.keyboard.press('Enter');
    await expect(page.locator('.marks .marked')).toHaveCount(1);
    // While a run has no figures yet, those of the last one cannot be pressed: their particles are gone.
    const disabled = await page.evaluate(async () => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const shows = [...document.querySelectorAll('.shows')];
      const now = () => shows.map((button) => button.getAttribute('aria-disabled'));
      const before = now();
      engine.run();
      while (engine.report.value) await new Promise((go) => setTimeout(go));
      return { before: new Set(before).has('true'), during: new Set(now()).has('false') };
    });
    expect(disabled).toEqual({ before: false, during: false });
    await settled(page);
    await page.getByRole('button', { name: 'Without relaxing' }).click();
    await expect(page.locator('.marks .marked')).toHaveCount(0);
    // Without a relaxation the places are those of the front.
    await page.getByRole('button', { name: /^Closest pair .*show it/ }).click();
    await expect(page.locator('.marks .marked')).toHaveCount(3);
  });
  await clean();
});
