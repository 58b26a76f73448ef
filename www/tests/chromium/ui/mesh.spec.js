import { stat } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { link } from '../engine/browser.js';
import { afresh, open, settled, state, typeFormula } from './helpers.js';

test('the mesh', async ({ page }) => {
  const { clean } = await open(page);
  await test.step('one press makes a mesh, tells whether it is closed, and every format is saved under its name', async () => {
    await page.getByRole('button', { name: 'Make a mesh' }).click();
    const panel = page.getByRole('region', { name: 'Mesh' });
    await expect(panel.locator('.verdict')).toHaveText(/^Closed · 1 part · 40\s×\s28(\.\d)?\s×\s20(\.\d)?\smm$/);
    const made = await state(page);
    expect(made.view.draw).toBe('mesh');
    expect(made.settings.method).toBeUndefined();
    await expect(panel.getByRole('button', { name: 'Save 3MF' })).toBeFocused();
    await panel.getByText('Details').click();
    await expect(panel.locator('.facts')).toContainText('Euler number2');
    for (const [use, formats] of /** @type {const} */ ([
      ['For printing', ['3mf', 'stl']],
      ['For viewers', ['glb', 'obj', 'ply', 'stl', '3mf']],
    ])) {
      await panel.getByRole('radio', { name: use }).check();
      for (const format of formats) {
        await panel.getByRole('combobox', { name: 'Format' }).selectOption(format);
        const [file] = await Promise.all([
          page.waitForEvent('download'),
          panel.getByRole('button', { name: `Save ${format.toUpperCase()}` }).click(),
        ]);
        expect(file.suggestedFilename()).toMatch(new RegExp(`^ellipsoid-\\d+-mesh\\.${format}$`));
      }
    }
    await panel.getByRole('radio', { name: 'For printing' }).check();
    const [bottom, levels] = await Promise.all([panel.boundingBox(), page.locator('.panel-levels').boundingBox()]);
    expect((bottom?.y ?? 0) + (bottom?.height ?? 0)).toBeLessThanOrEqual(levels?.y ?? 0);
    await page.keyboard.press('Escape');
    await expect(panel).toBeHidden();
    await expect(page.getByRole('button', { name: 'Make a mesh' })).toBeFocused();
    expect((await state(page)).view.draw).toBe('discs');
    await page.keyboard.press('Enter');
    await expect(panel).toBeVisible();
    await panel.getByRole('button', { name: 'Back to particles' }).click();
    expect((await state(page)).view.draw).toBe('discs');
    await page.getByRole('button', { name: 'Export', exact: true }).click();
    await page.getByRole('button', { name: 'Export mesh…' }).click();
    await expect(panel).toBeVisible();
    await typeFormula(page, 'x^2 +');
    await expect(panel).toBeHidden();
    await expect(page.getByRole('textbox', { name: 'Formula' })).toBeFocused();
  });

  await test.step('what is open is shown in the picture', async () => {
    await afresh(page, { hash: link({ surface: 'schwarz-p', settings: { radius_share: 0.02 } }) });
    await page.getByRole('button', { name: 'Make a mesh' }).click();
    const panel = page.getByRole('region', { name: 'Mesh' });
    await expect(panel.locator('.verdict')).toHaveText(/^Open: [\d,]+ open edges · /);
    await expect(panel).toContainText('A printer needs a closed surface');
    await panel.getByRole('button', { name: /^Show the next of \d+ borders$/ }).click();
    await expect(page.locator('polygon.marked')).toBeVisible();
    await page.keyboard.press('Escape');
  });

  await test.step('a part has its size and its wall in millimetres, and what is set for it stands in the panel', async () => {
    await afresh(page, { hash: link({ surface: 'gyroid', settings: { radius_share: 0.015, box_faces: 'closed' } }) });
    await page.getByRole('button', { name: 'Make a mesh' }).click();
    const panel = page.getByRole('region', { name: 'Mesh' });
    const [size, wall] = ['Longest side', 'Wall'].map((name) => panel.getByRole('spinbutton', { name }));
    const made = () => expect(panel.locator('.verdict')).toHaveText(/^Closed · /);
    await made();
    await size.fill('6 cm');
    await size.press('Enter');
    await expect(panel.locator('.verdict')).toHaveText(/60\s×\s60\s×\s60\smm$/);
    await wall.fill('3');
    await wall.press('Enter');
    await settled(page);
    await made();
    await expect(wall).toHaveValue('3');
    const { settings } = await state(page);
    const { min, max } = (await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.field.value))
      .bounds;
    expect(settings.thickness / (max[0] - min[0])).toBeCloseTo(3 / 60, 3);
    const kept = panel.locator('.mesh-kept li');
    await expect(kept).toHaveText([/^Thickness /, 'Closed by the box']);
    await expect(page.locator('.foot .kept')).toBeHidden();
    await panel.getByRole('button', { name: 'End the thickness' }).click();
    await expect(kept).toHaveText(['Closed by the box']);
    expect((await state(page)).settings.thickness).toBeUndefined();
    await page.keyboard.press('Escape');
  });

  await test.step('loose chips are counted, and leave the picture and the file by one press', async () => {
    const formula = 'min(hypot(x, y, z) - 1, hypot(x - 1.5, y, z) - 0.1, hypot(x + 1.5, y, z) - 0.1)';
    await afresh(page, { hash: link({ formula, settings: { radius_share: 0.01 } }) });
    await page.getByRole('button', { name: 'Make a mesh' }).click();
    const panel = page.getByRole('region', { name: 'Mesh' });
    await expect(panel.locator('.verdict')).toHaveText(/^Closed · 1 part and 2 loose chips · 60\s×\s/);
    const size = async () => {
      const [file] = await Promise.all([page.waitForEvent('download'), panel.locator('.save').click()]);
      return (await stat(await file.path())).size;
    };
    const before = await size();
    await panel.getByRole('button', { name: 'Leave out 2 loose chips' }).click();
    await expect(panel.locator('.verdict')).toHaveText(/^Closed · 1 part · 60\s×\s60\s×\s60\smm$/);
    expect(await size()).toBeLessThan(before);
    await page.keyboard.press('Escape');
  });

  await test.step('the way of drawing is chosen in the view options, and the mesh is judged in words', async () => {
    await afresh(page);
    await page.getByRole('button', { name: 'View options' }).click();
    await expect(page.getByRole('group', { name: 'Faces', exact: true })).toBeHidden();
    await page.getByRole('button', { name: 'Mesh', exact: true }).click();
    await expect(page.getByRole('slider', { name: 'Disc size' })).toBeHidden();
    await page.getByRole('button', { name: 'Flat' }).click();
    await page.getByRole('button', { name: 'Edges' }).click();
    await expect(page.getByRole('button', { name: 'Edges' })).toHaveAttribute('aria-pressed', 'false');
    expect((await state(page)).view).toMatchObject({ draw: 'mesh', faces: 'flat', edges: false, marks: true });
    await page.keyboard.press('Escape');
    await expect(page.locator('.caption .joined')).toHaveText(/^Closed · 1 part/);
    await page.locator('#stage').click({ position: { x: 5, y: 5 } });
    await page.keyboard.press('m');
    await expect(page.locator('.caption .joined')).toBeEmpty();
  });

  await test.step('the arrow keys pass over the lines of the view options that are hidden', async () => {
    await afresh(page);
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
  });

  await test.step('a refined surface is told as such', async () => {
    const settings = { method: 'refined', size_mode: 'count', count: 20_000 };
    await afresh(page, { hash: link({ surface: 'torus', settings }) });
    await expect(page.locator('.figures tr.group').filter({ hasText: 'Refined' })).toHaveCount(1);
  });
  await clean();
});

test('the legend says what the dots on the mesh mean, while there are some', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  // The dots are drawn by the graphics device.
  await page.goto('./?backend=webgl2');
  await settled(page);
  const dots = page.getByText('Dots: not six neighbours, but');
  await expect(dots).toBeHidden();
  const view = (/** @type {object} */ patch) =>
    page.evaluate((change) => /** @type {any} */ (window).marchingParticles.engine.setView(change), patch);
  await view({ draw: 'mesh' });
  await expect(dots).toBeVisible();
  await expect(page.locator('.legend .categories li')).toHaveText(['4 or fewer', '5', '7', '8 or more']);
  await view({ marks: false });
  await expect(dots).toBeHidden();
  await view({ marks: true });
  await expect(dots).toBeVisible();
  await view({ draw: 'discs' });
  await expect(dots).toBeHidden();
  await clean();
});
