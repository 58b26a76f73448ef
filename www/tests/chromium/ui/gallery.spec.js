import { expect, test } from '@playwright/test';
import { afresh, open, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const tile = (/** @type {Page} */ page, /** @type {string} */ id) => page.locator(`.tile[data-surface="${id}"]`);
const group = (/** @type {Page} */ page, /** @type {string} */ name) =>
  page.getByRole('group', { name: 'Groups of surfaces' }).getByRole('button', { name, exact: true });

test('the gallery', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('one group of surfaces is shown, that of the surface on the page, and keys alone choose in another', async () => {
    await expect(group(page, 'Closed')).toHaveAttribute('aria-pressed', 'true');
    await expect(tile(page, 'gyroid')).toBeHidden();
    await group(page, 'Periodic').focus();
    await page.keyboard.press('Enter');
    await expect(tile(page, 'gyroid')).toBeVisible();
    await expect(tile(page, 'ellipsoid')).toBeHidden();
    // Past the other groups, the search and the button for files.
    for (let presses = 0; presses < 6; presses += 1) await page.keyboard.press('Tab');
    await page.keyboard.press('Space');
    await settled(page);
    expect((await state(page)).surface).toBe('gyroid');
    await page.keyboard.press('ArrowRight');
    await settled(page);
    expect((await state(page)).surface).toBe('schwarz-p');
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ surface: 'plane' }));
    await expect(group(page, 'Open')).toHaveAttribute('aria-pressed', 'true');
    await expect(page.locator('.story .credit')).toContainText('Fejes Tóth');
  });

  await test.step('the search finds surfaces of all groups by their stories, and says so when there are none', async () => {
    await afresh(page, { width: 390, height: 844 });
    const search = page.getByRole('searchbox', { name: 'Find a surface' });
    await search.fill('minimal scherk');
    await expect(tile(page, 'saddle-tower')).toBeVisible();
    await expect(tile(page, 'ellipsoid')).toBeHidden();
    await search.fill('no such thing');
    await expect(page.locator('.gallery [role=status]')).toContainText('No surface');
    await search.press('Escape');
    await expect(search).toHaveValue('');
    await expect(tile(page, 'ellipsoid')).toBeVisible();
  });
  await clean();
});
