import { expect, test } from '@playwright/test';
import { afresh, open, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const tile = (/** @type {Page} */ page, /** @type {string} */ id) => page.locator(`.tile[data-surface="${id}"]`);
const groups = (/** @type {Page} */ page) => page.getByRole('combobox', { name: 'Group of surfaces' });

test('the gallery', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('one group of surfaces is shown, that of the surface on the page, and keys alone choose in another', async () => {
    await expect(groups(page)).toHaveValue('Closed');
    await expect(tile(page, 'gyroid')).toBeHidden();
    await groups(page).focus();
    await groups(page).selectOption('Periodic');
    await expect(tile(page, 'gyroid')).toBeVisible();
    await expect(tile(page, 'ellipsoid')).toBeHidden();
    // Past the search and the button for files.
    for (let presses = 0; presses < 3; presses += 1) await page.keyboard.press('Tab');
    await page.keyboard.press('Space');
    await settled(page);
    expect((await state(page)).surface).toBe('gyroid');
    await page.keyboard.press('ArrowRight');
    await settled(page);
    expect((await state(page)).surface).toBe('schwarz-p');
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ surface: 'plane' }));
    await expect(groups(page)).toHaveValue('Open');
    await expect(page.locator('.story .credit')).toContainText('Fejes Tóth');
  });

  await test.step('the search finds surfaces of all groups by their stories, and says so when there are none', async () => {
    await afresh(page, { width: 390, height: 844 });
    const search = page.getByRole('searchbox', { name: 'Find a surface' });
    await search.fill('minimal scherk');
    await expect(tile(page, 'saddle-tower')).toBeVisible();
    await expect(tile(page, 'ellipsoid')).toBeHidden();
    await expect(groups(page)).toHaveValue('All');
    // Words are found by their beginnings.
    await search.fill('nut');
    await expect(tile(page, 'drilled-block')).toBeVisible();
    await expect(tile(page, 'torus')).toBeHidden();
    await search.fill('no such thing');
    await expect(page.locator('.gallery [role=status]')).toContainText('No surface');
    await search.press('Escape');
    await expect(search).toHaveValue('');
    await expect(tile(page, 'ellipsoid')).toBeVisible();
    await expect(groups(page)).toHaveValue('Closed');
  });
  await clean();
});
