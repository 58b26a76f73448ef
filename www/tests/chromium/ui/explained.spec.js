/** A particle of the picture is explained in the lesson, where it is the same one. */
import { expect, test } from '@playwright/test';
import { expectDrawn } from './helpers.js';

test('a pressed particle is explained in the lesson, by its own number, and the way back leads to the picture', {
  tag: '@all',
}, async ({ page }) => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.goto('./?backend=canvas2d');
  await page.waitForFunction(
    () => /** @type {any} */ (window).marchingParticles?.engine.progress.value.phase === 'done',
  );
  await expectDrawn(page, 'canvas2d');
  // By keys: the particle in the middle, and once more to have it explained.
  await page.locator('#canvas-host').focus();
  await page.keyboard.press('Enter');
  const card = page.locator('.hover-card');
  const row = card.getByText('Particle', { exact: true }).locator('+ dd');
  const number = await row.innerText();
  await expect(card.getByRole('button', { name: 'Explain this particle' })).toBeVisible();
  await page.keyboard.press('Enter');
  await page.waitForURL(/learn\/#first&surface=.*&particle=/);
  const figure = page.locator('[data-figure="first"]');
  await expect(figure).toHaveAttribute('data-state', 'live');
  await expect(figure.getByText(new RegExp(`^Particle ${number} on level`))).toBeVisible();
  await expect(figure.locator('.algorithm [aria-current]')).toHaveCount(1);
  await page.getByRole('link', { name: 'Marching Particles', exact: true }).click();
  await page.waitForURL((url) => !url.pathname.includes('learn'));
});

test('of an adaptive picture the lesson explains no single particle, and the card says so', { tag: '@all' }, async ({
  page,
}) => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.goto('./?backend=canvas2d');
  await page.waitForFunction(() => 'marchingParticles' in window);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  await expectDrawn(page, 'canvas2d');
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({ settings: { sampling: 'adaptive', radius_min_share: 0.01 } }),
  );
  await page.locator('#canvas-host').focus();
  await page.keyboard.press('Enter');
  const card = page.locator('.hover-card');
  await expect(card).toContainText('The lesson explains single particles only where all have one size.');
  await expect(card.getByRole('button', { name: 'Explain this particle' })).toHaveCount(0);
  await card.getByRole('button', { name: 'How many sizes find room' }).click();
  await page.waitForURL(/learn\/#angles&surface=/);
  await expect(page.locator('[data-figure="angles"]')).toHaveAttribute('data-state', 'live');
});
