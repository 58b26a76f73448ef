/** Axes, lengths of the box, scale bar, and the distance of two particles. */
import { expect, test } from '@playwright/test';
import { atRest, open, scan, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {object} view */
async function look(page, view) {
  await page.evaluate((v) => /** @type {any} */ (window).marchingParticles.engine.setView(v), view);
  await atRest(page);
}

test('axes, lengths and scale bar are switched on in the view options and hold in the picture', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await expect(page.locator('.marks text')).toHaveCount(0);
  await page.getByRole('button', { name: 'View options' }).click();
  for (const name of ['Axes', 'Box', 'Bar']) await page.getByRole('button', { name, exact: true }).click();
  await page.keyboard.press('Escape');
  await atRest(page);
  expect((await state(page)).view).toMatchObject({ axes: true, box: true, bar: true });
  const texts = await page.locator('.marks text').allTextContents();
  expect(texts).toEqual(expect.arrayContaining(['x', 'y', 'z', '0', '0.5']));
  // The lengths of the box have their place where no axes are drawn.
  await look(page, { axes: false });
  expect(await page.locator('.marks text').allTextContents()).toEqual(['x 2.5', 'y 2.1', 'z 1.7']);
  await look(page, { axes: true });
  const bar = page.getByRole('img', { name: /Scale bar: 0\.\d+ units/ });
  await expect(bar).toBeVisible();
  const { length, px } = await page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const { target } = engine.state.value.view.camera;
    const text = document.querySelector('.scale-bar')?.textContent;
    return { length: Number(text), px: engine.project(target).perPx };
  });
  const drawn = await page.locator('.scale-bar > .line').evaluate((line) => line.getBoundingClientRect().width);
  expect(drawn * px).toBeCloseTo(length, 2);
  // Zooming in makes the bar stand for less.
  for (let i = 0; i < 6; i += 1) await page.getByRole('button', { name: 'Zoom in' }).click();
  await atRest(page);
  expect(Number(await bar.textContent())).toBeLessThan(length);
  expect((await scan(page)).violations).toEqual([]);
  await clean();
});

test('two particles are measured by pointer and by keyboard, and a link keeps them', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await atRest(page);
  await page.getByRole('button', { name: 'View options' }).click();
  await page.getByRole('button', { name: 'Measure a distance' }).click();
  const card = page.locator('.measure-card');
  await expect(card).toContainText('Press a particle');
  await page.mouse.click(700, 330);
  await expect(card).toContainText(/Particle [\d,]+: now another one/);
  await page.mouse.click(780, 400);
  await expect(card).toContainText(/0\.\d+ apart, [\d.]+ × 2r · particles/);
  const { measured } = (await state(page)).view;
  const { units, told } = await page.evaluate(([i, j]) => {
    const { positions } = /** @type {any} */ (window).marchingParticles.particles();
    const units = Math.hypot(...[0, 1, 2].map((k) => positions[3 * i + k] - positions[3 * j + k]));
    return { units, told: parseFloat(document.querySelector('.measure-card')?.textContent ?? '') };
  }, measured);
  expect(told).toBeCloseTo(units, 3);

  // By keyboard: what is under the cross, then what comes under it as the surface is turned.
  await page.locator('#canvas-host').focus();
  await page.keyboard.press('Enter');
  await expect.poll(async () => (await state(page)).view.measured.length).toBe(1);
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('Enter');
  await expect.poll(async () => (await state(page)).view.measured.length).toBe(2);
  await expect(page.locator('.marks .cross')).toHaveCount(2);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  const kept = (await state(page)).view.measured;
  expect((await scan(page)).violations).toEqual([]);

  await page.getByRole('button', { name: 'Done' }).click();
  await expect(card).toBeHidden();
  // To go to the address where the page still is would change nothing.
  await expect.poll(() => new URL(page.url()).hash).not.toBe(new URL(link).hash);
  await open(page, { width: 390, height: 844, hash: new URL(link).hash });
  // The same page reads a link that differs in its fragment alone, a little later.
  await expect.poll(async () => (await state(page)).view.measured).toEqual(kept);
  await expect(card).toContainText('apart');
  await look(page, { measured: [4_000_000] });
  // A particle that is not there is not measured.
  await expect(card).toContainText('Press a particle');
  await clean();
});
