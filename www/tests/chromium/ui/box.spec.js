import { expect, test } from '@playwright/test';
import { afresh, open, report, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const cut = (/** @type {Page} */ page) => page.locator('.cut');

test('the box around a formula', async ({ page }) => {
  test.slow();
  const { clean } = await open(page);
  await test.step('a surface that goes on for ever is said to, and the box can be enlarged and fitted again', async () => {
    await typeFormula(page, 'sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)');
    await settled(page);
    await expect(cut(page)).toContainText('continues outside the box');
    await cut(page).getByRole('button', { name: 'Enlarge' }).click();
    await settled(page);
    expect((await state(page)).bounds).toEqual({ min: [-8, -8, -8], max: [8, 8, 8] });
    await expect(cut(page)).toContainText('The box cuts the surface');
    await cut(page).getByRole('button', { name: 'Fit' }).click();
    await settled(page);
    expect((await state(page)).bounds).toBeNull();
    await expect(cut(page)).toContainText('continues outside the box');
  });

  await test.step('a periodic surface is sampled in a whole number of its periods by one press', async () => {
    await page.locator('.clip > summary', { hasText: 'Clip box' }).click();
    const periods = page.getByRole('group', { name: 'Whole periods' });
    await expect(periods.getByRole('button')).toHaveText(['1 ×', '2 ×', '3 ×']);
    await periods.getByRole('button', { name: '2 ×' }).click();
    await settled(page);
    const side = 2 * Math.PI;
    expect((await state(page)).bounds).toEqual({ min: [-side, -side, -side], max: [side, side, side] });
    await expect(periods.getByRole('button', { name: '2 ×' })).toHaveAttribute('aria-pressed', 'true');
    await afresh(page);
    await typeFormula(page, 'x^2+y^2+z^2=1');
    await settled(page);
    await expect(periods).toBeHidden();
  });

  await test.step('a formula without a surface is told so, as far as it was searched', async () => {
    await afresh(page);
    await typeFormula(page, 'x^2+y^2+z^2=-1');
    await settled(page);
    await expect(page.locator('.empty')).toContainText('No surface within ±10,000');
    await expect(page.getByRole('button', { name: 'Double the box' })).toHaveCount(0);
  });

  await test.step('one press mends every place of a kind', async () => {
    await afresh(page);
    await typeFormula(page, 'x2 + y2 + z2 = 1');
    await page.getByRole('button', { name: 'Change to x^2, in all 3 places' }).click();
    await expect.poll(async () => (await state(page)).formula).toBe('x^2 + y^2 + z^2 = 1');
    await settled(page);
    expect((await report(page)).quality.euler).toBe(2);
    await expect(cut(page)).toBeHidden();
    await expect(page.locator('.clip .range')).toHaveText(/^fits · 2\.2\d? × 2\.2\d? × 2\.2\d?$/);
  });

  await test.step('a long formula is typeset in a box that scrolls', async () => {
    await afresh(page);
    const terms = Array.from({ length: 100 }, (_, k) => `sin(${k + 1}x)/${k + 1}^3`);
    await typeFormula(page, `x^2 + y^2 + z^2 + ${terms.join(' + ')} = 1`);
    const preview = page.locator('.preview');
    await expect.poll(() => preview.evaluate((box) => box.scrollHeight > box.clientHeight)).toBe(true);
    expect(await preview.evaluate((box) => box.clientHeight)).toBeLessThan(200);
    await settled(page);
  });

  await clean();
});
