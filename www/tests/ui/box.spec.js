import { expect, test } from '@playwright/test';
import { open, report, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const cut = (/** @type {Page} */ page) => page.locator('.cut');

test('a sphere typed letter by letter over the ellipsoid is whole', async ({ page }) => {
  const { clean } = await open(page);
  await typeFormula(page, '');
  await page.keyboard.type('x^2+y^2+z^2=1');
  await expect.poll(async () => (await state(page)).formula).toBe('x^2+y^2+z^2=1');
  await settled(page);
  const { quality, border } = await report(page);
  expect([quality.euler, border]).toEqual([2, 0]);
  await expect(cut(page)).toBeHidden();
  await expect(page.locator('.clip .range')).toHaveText(/^fits · 2\.2\d? × 2\.2\d? × 2\.2\d?$/);
  expect((await state(page)).bounds).toBeNull();
  await clean();
});

test('a surface that goes on for ever is said to, and the box can be enlarged and fitted again', async ({ page }) => {
  const { clean } = await open(page);
  await typeFormula(page, 'sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)');
  await settled(page);
  await expect(cut(page)).toContainText('goes on beyond the box');
  await cut(page).getByRole('button', { name: 'Enlarge' }).click();
  await settled(page);
  expect((await state(page)).bounds).toEqual({ min: [-8, -8, -8], max: [8, 8, 8] });
  await expect(cut(page)).toContainText('The box cuts the surface');
  await cut(page).getByRole('button', { name: 'Fit' }).click();
  await settled(page);
  expect((await state(page)).bounds).toBeNull();
  await expect(cut(page)).toContainText('goes on beyond the box');
  await clean();
});

test('of an endless surface of short period the box holds two periods', async ({ page }) => {
  const { clean } = await open(page);
  await typeFormula(page, 'cos(10x)+cos(10y)+cos(10z)');
  await settled(page);
  const { max } = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.field.value.bounds);
  for (const end of max) expect(end).toBeCloseTo(Math.PI / 5, 6);
  await expect(cut(page)).toContainText('goes on beyond the box');
  await clean();
});

test('a formula without a surface is told so, as far as it was searched', async ({ page }) => {
  const { clean } = await open(page);
  await typeFormula(page, 'x^2+y^2+z^2=-1');
  await settled(page);
  await expect(page.locator('.empty')).toContainText('No surface within ±10,000');
  await expect(page.getByRole('button', { name: 'Double the box' })).toHaveCount(0);
  await clean();
});

test('LaTeX is read as it is pasted, and one press mends every place of a kind', async ({ page }) => {
  const { clean } = await open(page);
  await typeFormula(page, String.raw`f(x,y,z) = \frac{x^{2}}{4} + \left|y\right|^2 + z**2 - 1`);
  await settled(page);
  expect((await report(page)).quality.euler).toBe(2);
  await typeFormula(page, 'x2 + y2 + z2 = 1');
  await page.getByRole('button', { name: 'Change to x^2, in all 3 places' }).click();
  await expect.poll(async () => (await state(page)).formula).toBe('x^2 + y^2 + z^2 = 1');
  await settled(page);
  expect((await report(page)).quality.euler).toBe(2);
  await clean();
});

test('a long formula is typeset in a box that scrolls', async ({ page }) => {
  const { clean } = await open(page);
  const terms = Array.from({ length: 100 }, (_, k) => `sin(${k + 1}x)/${k + 1}^3`);
  await typeFormula(page, `x^2 + y^2 + z^2 + ${terms.join(' + ')} = 1`);
  const preview = page.locator('.preview');
  await expect.poll(() => preview.evaluate((box) => box.scrollHeight > box.clientHeight)).toBe(true);
  expect(await preview.evaluate((box) => box.clientHeight)).toBeLessThan(200);
  await settled(page);
  await clean();
});

test('a key typed while the box of a heavy formula is searched is answered, and its error shown', async ({ page }) => {
  const { clean } = await open(page);
  const terms = Array.from({ length: 60 }, (_, k) => `sin(${k + 1}x+y)cos(${k + 2}z)`);
  const heavy = `z = ${terms.join('+')}`;
  await page.evaluate(async (text) => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.setFormula(text);
    engine.setFormula(`${text}+foo(`);
  }, heavy);
  await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveAttribute('aria-invalid', 'true');
  await typeFormula(page, 'x^2+y^2+z^2=1');
  await settled(page);
  expect((await report(page)).quality.euler).toBe(2);
  await clean();
});
