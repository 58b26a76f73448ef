/** Colours and spacings by formulas. */
import { expect, test } from '@playwright/test';
import { COARSE, open, report, settled, state } from './helpers.js';

test('particles are coloured by a formula, and spaced by one, which links and undo keep', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });

  await test.step('a formula colours them, with its legend, and a mistake is told', async () => {
    await page.getByRole('combobox', { name: 'Colour by' }).selectOption('value');
    const box = page.getByRole('combobox', { name: 'Formula of the colours' });
    await expect(box).toHaveValue('k_1 k_2');
    await expect(page.locator('.legend .ends')).toBeVisible();
    await box.fill('z + q');
    await box.press('Enter');
    await expect(page.locator('.legend-value .fault-line')).toContainText('q');
    await box.fill('hypot(x, y)');
    await box.press('Enter');
    await expect(page.locator('.legend-value .fault-line')).toBeHidden();
    await expect(page.locator('.legend .ends')).toBeVisible();
    const worst = await page.evaluate(() => {
      const { columns } = /** @type {any} */ (window).marchingParticles.engine;
      let far = 0;
      for (let i = 0; i < columns.count; i += 1)
        far = Math.max(
          far,
          Math.abs(columns.value[i] - Math.hypot(columns.positions[3 * i], columns.positions[3 * i + 1])),
        );
      return far;
    });
    expect(worst).toBeLessThan(1e-5);
    const csv = await page.evaluate(async () =>
      (await /** @type {any} */ (window).marchingParticles.engine.exportFile('csv')).text(),
    );
    expect(csv.split('\n')[0].split(',').at(-1)).toBe('value');
    const json = await page.evaluate(async () =>
      (await /** @type {any} */ (window).marchingParticles.engine.exportFile('json')).text(),
    );
    expect(JSON.parse(json).marching_particles.values).toEqual([{ name: 'value', formula: 'hypot(x, y)' }]);
  });

  await test.step('a formula spaces them, and a mistake is told', async () => {
    await page.getByRole('button', { name: 'Advanced' }).click();
    const box = page.getByRole('textbox', { name: 'Spacing' });
    await box.fill('0.06 + 0.1 q');
    await box.press('Enter');
    await expect(page.locator('.setting-text .fault-line')).toContainText('Spacing: The formula has no parameter');
    await box.fill('0.06 + 0.02 z');
    await box.press('Enter');
    await settled(page);
    expect((await state(page)).settings.spacing).toBe('0.06 + 0.02 z');
    const { radius_min: least, radius_max: most } = await report(page);
    expect(most / least).toBeGreaterThan(1.2);
    await page.getByRole('button', { name: 'Show as colours' }).click();
    expect((await state(page)).view.colour).toBe('radius');
  });

  await test.step('a link keeps both, and undo ends the spacing', async () => {
    const { digest } = await report(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ colour: 'value' }));
    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    await page.getByRole('button', { name: 'Undo', exact: true }).click();
    await settled(page);
    expect((await state(page)).settings.spacing).toBeUndefined();
    await page.goto('about:blank');
    await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
    await settled(page);
    expect((await report(page)).digest).toBe(digest);
    expect((await state(page)).view).toMatchObject({ colour: 'value', value: 'hypot(x, y)' });
  });
  await clean();
});
