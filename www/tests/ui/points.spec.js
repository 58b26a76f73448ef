import { expect, test } from '@playwright/test';
import { open, report, scan } from './helpers.js';

/** @typedef {import('@playwright/test').Page} Page */

/** A drag with a file, or with text. @param {Page} page @param {string} type @param {{ name: string, text?: string, bytes?: number } | null} file */
const drag = (page, type, file) => page.evaluate(({ type, file }) => {
  const transfer = new DataTransfer();
  if (file) transfer.items.add(new File([file.bytes ? new Uint8Array(file.bytes) : file.text ?? ''], file.name));
  else transfer.items.add('words', 'text/plain');
  const target = document.querySelector('.preview') ?? document.body;
  const event = new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true });
  target.dispatchEvent(event);
  return event.defaultPrevented;
}, { type, file });

const dropped = async (/** @type {Page} */ page, /** @type {{ name: string, text?: string, bytes?: number }} */ file) => {
  await drag(page, 'dragover', file);
  await drag(page, 'drop', file);
};

test('a file dragged over the page is shown where it may be dropped, with the formats and the limit', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  const { clean } = await open(page, { width: 1440, height: 900 });
  const overlay = page.locator('.drop');
  await expect(overlay).toBeHidden();
  await drag(page, 'dragenter', null);
  expect(await drag(page, 'dragover', null)).toBe(false);
  await expect(overlay).toBeHidden();
  await drag(page, 'dragenter', { name: 'a.ply' });
  expect(await drag(page, 'dragover', { name: 'a.ply' })).toBe(true);
  await expect(overlay).toBeVisible();
  for (const word of ['PLY', 'OBJ', 'STL', 'XYZ', '50']) await expect(overlay).toContainText(word);
  expect((await scan(page)).violations).toEqual([]);
  await drag(page, 'dragleave', { name: 'a.ply' });
  await expect(overlay).toBeHidden();
  await clean();
});

test('a file too large is refused at once, with the reason and what to do, and the surface stays', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await open(page, { width: 1440, height: 900 });
  const { digest } = await report(page);
  await dropped(page, { name: 'statue.ply', bytes: 51_000_000 });
  const box = page.locator('.refused');
  await expect(box).toContainText('statue.ply could not be used');
  await expect(box).toContainText('50');
  await expect(page.locator('.loading ~ [role=status], [role=status].visually-hidden', { hasText: 'statue.ply could not be used' })).toHaveCount(1);
  await expect(page.locator('.toast')).toHaveCount(0);
  expect((await report(page)).digest).toBe(digest);
  expect((await scan(page)).violations).toEqual([]);
  await page.locator('.tile[data-surface="sphere"]').click();
  await expect(box).toBeHidden();
});

test('keys alone open the chooser for files', async ({ page }) => {
  // Asked for before there is anything to press, so that the browser knows in time.
  const chosen = page.waitForEvent('filechooser');
  await open(page);
  await page.getByRole('button', { name: 'Open file…' }).focus();
  await page.keyboard.press('Enter');
  const chooser = await chosen;
  expect(chooser.isMultiple()).toBe(false);
  expect(await page.locator('input[type=file]').getAttribute('accept')).toContain('.ply');
});

test('what is on its way shows its stage and can be given up', async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  const { clean } = await open(page, { width: 1440, height: 900 });
  await page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.loading.value = { id: 'bunny', name: 'Bunny', stage: 'solving', label: 'Solving', fraction: 0.42 };
  });
  const bar = page.getByRole('progressbar', { name: 'Loading Bunny' });
  await expect(bar).toHaveAttribute('aria-valuenow', '42');
  await expect(page.locator('.loading')).toContainText('Solving');
  await expect(page.getByRole('button', { name: 'Cancel' })).toBeVisible();
  expect((await scan(page)).violations).toEqual([]);
  await clean();
});
