/** Files of triangle meshes on the page. */
import { expect, test } from '@playwright/test';
import { COARSE, open, report, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1].join(' '));
const SQUARES = ['0 2 3 1', '4 5 7 6', '0 1 5 4', '2 6 7 3', '0 4 6 2', '1 3 7 5'];
/** A cube of the side 2, of which the last squares may be missing. */
const offOf = (count = 6) =>
  Buffer.from(['OFF', `8 ${count} 0`, ...CORNERS, ...SQUARES.slice(0, count).map((f) => `4 ${f}`), ''].join('\n'));

/** A saddle of n × n squares. @param {number} n */
function sheetOf(n) {
  const rows = ['OFF', `${(n + 1) ** 2} ${n * n} 0`];
  for (let k = 0; k < (n + 1) ** 2; k += 1) {
    const [x, y] = [(k % (n + 1)) - n / 2, Math.floor(k / (n + 1)) - n / 2];
    rows.push(`${x} ${y} ${(x * x - y * y) / (2 * n)}`);
  }
  for (let k = 0; k < n * n; k += 1) {
    const at = (k % n) + (n + 1) * Math.floor(k / n);
    rows.push(`4 ${at} ${at + 1} ${at + n + 2} ${at + n + 1}`);
  }
  return Buffer.from([...rows, ''].join('\n'));
}

/** @param {Page} page @param {string} name @param {Buffer} buffer */
const choose = (page, name, buffer) =>
  page.locator('input[type=file]').setInputFiles({ name, mimeType: 'application/octet-stream', buffer });

test('a mesh is sampled anew with its edges, or as points, and says what has become of it', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  const panel = page.locator('.remesh');
  await choose(page, 'cube.off', offOf());
  await expect(page.getByRole('heading', { name: 'cube.off' })).toBeVisible();
  await settled(page);

  await test.step('what it has, and how far the new mesh is from it', async () => {
    await expect(panel).toContainText('12 faces with 8 vertices in 1 piece.');
    await expect(panel).toContainText('6 patches between 12 sharp edges of the mesh and 8 corners');
    await expect(panel.locator('dd').nth(3)).toHaveText('8 → 8 (the same)');
    const { quality } = await report(page);
    expect(quality.area).toBeCloseTo(24, 2);
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('without edges it is a scan, and a slider rounds it', async () => {
    await panel.getByRole('radio', { name: 'None' }).check();
    await settled(page);
    await expect(panel).toContainText('A scan, without sharp edges');
    await page.getByRole('spinbutton', { name: 'Smoothing smooth, number' }).fill('4');
    await page.getByRole('spinbutton', { name: 'Smoothing smooth, number' }).press('Enter');
    await settled(page);
    expect((await state(page)).parameters).toEqual({ edges: 0, smooth: 4 });
    expect((await report(page)).quality.area).toBeLessThan(23.9);
    await panel.getByRole('radio', { name: 'By angle' }).check();
    await settled(page);
    expect((await state(page)).parameters).toEqual({ edges: 30 });
  });

  await test.step('its points have a smooth surface', async () => {
    await panel.getByRole('radio', { name: 'Points' }).check();
    await settled(page);
    await expect(panel).toBeHidden();
    const model = page.locator('.model');
    await expect(model.getByRole('radio', { name: 'Points' })).toBeChecked();
    await model.getByRole('radio', { name: 'Surface' }).check();
    await settled(page);
    await expect(panel).toBeVisible();
  });

  await test.step('it is an operand, and one press leads back to the formula', async () => {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setFormula('max(model, z)'));
    await settled(page);
    expect((await report(page)).quality.area).toBeCloseTo(16, 1);
    await page.getByRole('button', { name: 'Back to the formula' }).first().click();
    await settled(page);
    await expect(panel).toBeHidden();
  });
  await clean();
});

test('a sheet ends at its border, and a link asks for the file', async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844, hash: COARSE });
  await choose(page, 'open.off', offOf(5));
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('Holes with 4 edges at their borders are closed smoothly.');
  await page.locator('.remesh').getByRole('radio', { name: 'Kept' }).check();
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('The surface ends at its border, 1 closed curve of 4 edges.');
  expect((await report(page)).quality.area).toBeCloseTo(20, 1);
  expect((await state(page)).parameters).toEqual({ borders: 1 });
  await choose(page, 'sheet.off', sheetOf(20));
  await expect(page.getByRole('heading', { name: 'sheet.off' })).toBeVisible();
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('The surface ends at its border, 1 closed curve of 80 edges.');
  await choose(page, 'open.off', offOf(5));
  await settled(page);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await page.goto('about:blank');
  await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
  await expect(page.locator('.toast')).toContainText('in a file');
  await settled(page);
  await clean();
});
