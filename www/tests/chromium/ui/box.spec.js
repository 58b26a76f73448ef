import { expect, test } from '@playwright/test';
import { afresh, atRest, open, report, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const cut = (/** @type {Page} */ page) => page.locator('.cut');

test('the box around a formula', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await test.step('a surface that goes on for ever is said to, and the box can be enlarged and fitted again', async () => {
    await typeFormula(page, 'sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)');
    await settled(page);
    await expect(cut(page)).toContainText('continues outside the box');
    await cut(page).getByRole('button', { name: 'Enlarge' }).click();
    await settled(page);
    expect((await state(page)).bounds).toMatchObject({ min: [-8, -8, -8], max: [8, 8, 8] });
    // A larger box is no cure for what has no end.
    await expect(cut(page)).toContainText('no end');
    await expect(cut(page).getByRole('button', { name: 'Enlarge' })).toHaveCount(0);
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

  await test.step('a surface in an enlarged box is fitted, wherever the hand has left the camera', async () => {
    await afresh(page);
    await typeFormula(page, 'x^2+y^2=1');
    await settled(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.zoom(2));
    await cut(page).getByRole('button', { name: 'Enlarge' }).click();
    await settled(page);
    await atRest(page);
    const [top, bottom] = await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      return [8, -8].map((z) => engine.project([0, 0, z]).y);
    });
    expect(top).toBeGreaterThan(0);
    expect(bottom).toBeLessThan(800);
  });

  await test.step('an enlarged box ends with its formula; one that was typed stays, and the page says so', async () => {
    const kept = page.locator('.foot .kept');
    await expect(kept).toContainText('Enlarged box');
    // Also after its link was opened again.
    await page.evaluate(async () => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      await engine.openLink(await engine.link());
    });
    await settled(page);
    await expect(kept).toContainText('Enlarged box');
    await typeFormula(page, 'x^2+y^2+z^2=1');
    await settled(page);
    await expect(kept).toBeHidden();
    expect((await state(page)).bounds).toBeNull();
    expect((await report(page)).count).toBeGreaterThan(5000);
    await page.evaluate(() =>
      /** @type {any} */ (window).marchingParticles.engine.setBounds({ min: [-2, -2, -2], max: [2, 2, 2] }),
    );
    await typeFormula(page, 'x^2+y^2+2z^2=1');
    await settled(page);
    await expect(kept).toContainText('Box set by hand');
    expect((await state(page)).bounds.max).toEqual([2, 2, 2]);
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
