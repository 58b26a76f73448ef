/** A solid from a surface: closed by its box, and a sheet of some thickness; in links and in the history. */
import { expect, test } from '@playwright/test';
import { afresh, open, report, settled, state } from './helpers.js';

test('a periodic surface becomes a closed part, and a surface again', async ({ page }) => {
  const { clean } = await open(page);
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({ surface: 'schwarz-p', settings: { radius_share: 0.012 } }),
  );
  const closed = page.getByRole('checkbox', { name: 'Closed' });
  const thickness = page.getByLabel('Thickness');
  const before = await state(page);
  await closed.check();
  await settled(page);
  const shown = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().progress.particles);
  const { creases, cut, count } = await report(page);
  expect(creases).toBeGreaterThan(0);
  expect([cut, shown]).toEqual([null, count]);
  await test.step('what is no thickness is refused in words', async () => {
    await thickness.fill('-1');
    await thickness.press('Enter');
    await expect(page.getByRole('alert')).toContainText('from 0 on');
    expect((await state(page)).settings.thickness).toBeUndefined();
  });
  await test.step('links and the history have the choices', async () => {
    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    await page.getByRole('button', { name: 'Undo' }).click();
    await settled(page);
    await expect(closed).not.toBeChecked();
    expect((await state(page)).settings).toEqual(before.settings);
    await afresh(page, { hash: new URL(link).hash });
    await expect(closed).toBeChecked();
    expect((await report(page)).creases).toBe(creases);
  });
  await test.step('a model from points has no solid', async () => {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ surface: 'bunny' }));
    await expect(closed).toBeHidden();
  });
  await clean();
});
