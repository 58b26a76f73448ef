import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { link } from '../engine/browser.js';
import { open, settled, state } from './helpers.js';

const golden = JSON.parse(await readFile(new URL('../../../tests/golden/meshes.json', import.meta.url), 'utf8'));

/** FNV-1a, 64 bits. @param {Uint8Array} bytes */
function digestOf(bytes) {
  let hash = 0xcbf29ce484222325n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  return hash.toString(16).padStart(16, '0');
}

test('the mesh that is downloaded is byte for byte that of the command line', async ({ page }) => {
  const [{ field, settings, files }] = golden.runs;
  const { clean } = await open(page, { hash: link({ surface: field.surface, settings }) });
  for (const format of ['glb', 'obj', 'stl', 'ply']) {
    await page.getByRole('button', { name: 'Export', exact: true }).click();
    const [file] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('button', { name: `Export mesh ${format.toUpperCase()}` }).click(),
    ]);
    expect(file.suggestedFilename()).toMatch(new RegExp(`^ellipsoid-\\d+-mesh\\.${format}$`));
    expect(digestOf(await readFile(await file.path())), format).toBe(files[format]);
  }
  await clean();
});

test('the way of drawing is chosen in the view options, and in words where there can be no mesh', async ({ page }) => {
  const { clean } = await open(page);
  await page.getByRole('button', { name: 'View options' }).click();
  await expect(page.getByRole('group', { name: 'Faces', exact: true })).toBeHidden();
  await page.getByRole('button', { name: 'Mesh', exact: true }).click();
  await expect(page.getByRole('slider', { name: 'Disc size' })).toBeHidden();
  await page.getByRole('button', { name: 'Flat' }).click();
  await page.getByRole('button', { name: 'Edges' }).click();
  await expect(page.getByRole('button', { name: 'Edges' })).toHaveAttribute('aria-pressed', 'false');
  expect((await state(page)).view).toMatchObject({ draw: 'mesh', faces: 'flat', edges: false, marks: true });
  await page.keyboard.press('Escape');
  // The tests of the panels draw without a graphics device.
  await expect(page.locator('.caption .joined')).toHaveText(/needs WebGPU or WebGL2/);
  await page.locator('#stage').click({ position: { x: 5, y: 5 } });
  await page.keyboard.press('m');
  await expect(page.locator('.caption .joined')).toBeEmpty();
  await clean();
});

test('the arrow keys pass over the lines of the view options that are hidden', async ({ page }) => {
  const { clean } = await open(page);
  await page.getByRole('button', { name: 'View options' }).click();
  const menu = page.locator('[popover]:popover-open');
  const shown = await menu.locator('button:visible').count();
  expect(await menu.locator('button').count()).toBeGreaterThan(shown);
  const first = menu.locator('button:visible').first();
  await first.focus();
  for (let k = 1; k < shown; k += 1) {
    await page.keyboard.press('ArrowDown');
    await expect(menu.locator('button:visible').nth(k)).toBeFocused();
  }
  await page.keyboard.press('ArrowDown');
  await expect(first).toBeFocused();
  await clean();
});

test('a refined surface is told as such, and shows its coarse level while a slider is dragged', async ({ page }) => {
  const settings = { method: 'refined', size_mode: 'count', count: 20_000 };
  const { clean } = await open(page, { hash: link({ surface: 'torus', settings }) });
  await expect(page.locator('.figures tr.group').filter({ hasText: 'Refined' })).toHaveCount(1);
  const seen = await page.evaluate(async () => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    /** @type {Set<number>} */
    const counts = new Set();
    engine.progress.subscribe((/** @type {any} */ { live, phase }) => {
      if (live && phase === 'done' && engine.columns.count > 0) counts.add(engine.columns.count);
    });
    const [parameter] = engine.field.value.parameters;
    // A busy machine may not finish the first ones. The pause is shorter than that after which a drag counts as over.
    for (let k = 1; k <= 30 && counts.size === 0; k += 1) {
      engine.setParameter(parameter.name, parameter.value * (1 + k / 600), { live: true });
      await new Promise((resolve) => setTimeout(resolve, 200));
    }
    engine.setParameter(parameter.name, parameter.value * 1.04);
    return [...counts];
  });
  expect(seen.length).toBeGreaterThan(0);
  for (const count of seen) expect(count).toBeLessThan(8000);
  await settled(page);
  const { count } = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.report());
  expect(count).toBeGreaterThan(19_000);
  await clean();
});
