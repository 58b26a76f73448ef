/** Files of triangle meshes on the page. */
import { expect, test } from '@playwright/test';
import { COARSE, open, report, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1].join(' '));
const SQUARES = ['0 2 3 1', '4 5 7 6', '0 1 5 4', '2 6 7 3', '0 4 6 2', '1 3 7 5'];
/** A cube of the side 2, of which the last squares may be missing. */
const offOf = (count = 6) =>
  Buffer.from(['OFF', `8 ${count} 0`, ...CORNERS, ...SQUARES.slice(0, count).map((f) => `4 ${f}`), ''].join('\n'));

/** A saddle of n × n squares. @param {number} n */
function sheetOf(n) {
  const rows = ['OFF', `${(n + 1) ** 2} ${n * n} 0`];
  for (let k = 0; k < (n + 1) ** 2; k += 1) {
    const [x, y] = [(k % (n + 1)) - n / 2, Math.floor(k / (n + 1)) - n / 2];
    rows.push(`${x} ${y} ${(x * x - y * y) / (2 * n)}`);
  }
  for (let k = 0; k < n * n; k += 1) {
    const at = (k % n) + (n + 1) * Math.floor(k / n);
    rows.push(`4 ${at} ${at + 1} ${at + n + 2} ${at + n + 1}`);
  }
  return Buffer.from([...rows, ''].join('\n'));
}

/** @param {Page} page @param {string} name @param {Buffer} buffer */
const choose = (page, name, buffer) =>
  page.locator('input[type=file]').setInputFiles({ name, mimeType: 'application/octet-stream', buffer });

test('a mesh is sampled anew with its edges, or as points, and says what has become of it', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  const panel = page.locator('.remesh');
  await choose(page, 'cube.off', offOf());
  await expect(page.getByRole('heading', { name: 'cube.off' })).toBeVisible();
  await settled(page);

  await test.step('what it has, and how far the new mesh is from it', async () => {
    await expect(panel).toContainText('12 faces with 8 vertices in 1 piece.');
    await expect(panel).toContainText('6 patches between 12 sharp edges of the mesh and 8 corners');
    await expect(panel.locator('dd').nth(3)).toHaveText('8 → 8 (the same)');
    const { quality } = await report(page);
    expect(quality.area).toBeCloseTo(24, 2);
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('without edges it is a scan, and a slider rounds it', async () => {
    await panel.getByRole('radio', { name: 'None' }).check();
    await settled(page);
    await expect(panel).toContainText('A scan, without sharp edges');
    await page.getByRole('spinbutton', { name: 'Smoothing smooth, number' }).fill('4');
    await page.getByRole('spinbutton', { name: 'Smoothing smooth, number' }).press('Enter');
    await settled(page);
    expect((await state(page)).parameters).toEqual({ edges: 0, smooth: 4 });
    expect((await report(page)).quality.area).toBeLessThan(23.9);
    await panel.getByRole('radio', { name: 'By angle' }).check();
    await settled(page);
    expect((await state(page)).parameters).toEqual({ edges: 30 });
  });

  await test.step('its points have a smooth surface', async () => {
    await panel.getByRole('radio', { name: 'Points' }).check();
    await settled(page);
    await expect(panel).toBeHidden();
    const model = page.locator('.model');
    await expect(model.getByRole('radio', { name: 'Points' })).toBeChecked();
    await model.getByRole('radio', { name: 'Surface' }).check();
    await settled(page);
    await expect(panel).toBeVisible();
  });

  await test.step('it is an operand, and one press leads back to the formula', async () => {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setFormula('max(model, z)'));
    await settled(page);
    expect((await report(page)).quality.area).toBeCloseTo(16, 1);
    await page.getByRole('button', { name: 'Back to the formula' }).first().click();
    await settled(page);
    await expect(panel).toBeHidden();
  });
  await clean();
});

/** A block without the rim of its top: sides that lean in by 20° from 0.75 up to 1. */
const LEAN = 0.25 / Math.tan((20 * Math.PI) / 180);
function chamfered() {
  const ring = (/** @type {number} */ half, /** @type {number} */ z) =>
    [0, 1, 2, 3].map((k) => [k & 1 ? half : -half, k & 2 ? half : -half, z].join(' '));
  const corners = [...ring(2, 0), ...ring(2, 0.75), ...ring(2 - LEAN, 1)];
  const walls = [0, 4].flatMap((at) =>
    [
      [0, 1],
      [1, 3],
      [3, 2],
      [2, 0],
    ].map(([a, b]) => `4 ${at + a} ${at + b} ${at + 4 + b} ${at + 4 + a}`),
  );
  return Buffer.from(['OFF', '12 10 0', ...corners, '4 0 2 3 1', '4 8 9 11 10', ...walls, ''].join('\n'));
}

/** Where a place of the surface is in the window. @param {Page} page @param {number[]} place */
const windowOf = (page, place) =>
  page.evaluate((place) => {
    const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
    const { x, y } = /** @type {any} */ (window).marchingParticles.engine.project(place);
    return { x: host.left + x, y: host.top + y };
  }, place);

/** @param {Page} page */
const lookFromAbove = (page) =>
  page.evaluate(async () => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.lookFrom('top');
    await engine.debug.still();
  });

test('edges are marked in the picture, by mouse and keys, undone, kept by other settings and copied', {
  tag: '@all',
}, async ({ page, context }) => {
  await context.grantPermissions(['clipboard-read', 'clipboard-write']);
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  const panel = page.locator('.remesh');
  const card = page.getByRole('group', { name: 'Mark edges' });
  const marks = page.locator('.marks .kept');
  const lines = async () => (await state(page)).lines.length;
  await choose(page, 'block.off', chamfered());
  await settled(page);
  // The faces of a coarse model would all stay sharp.
  await panel.getByRole('radio', { name: 'By angle' }).check();
  await settled(page);
  await lookFromAbove(page);
  await panel.getByRole('button', { name: 'Mark edges' }).click();
  await expect(card.getByRole('status')).toHaveText('Press an edge to keep it sharp');
  const top = 2 - LEAN;
  const rim = [
    [top, 0, 1],
    [-top, 0, 1],
    [0, top, 1],
    [0, -top, 1],
  ];
  const mitres = [0, 1, 2, 3].map((k) => [k & 1, k >> 1].map((side) => (2 * side - 1) * (2 - LEAN / 2)).concat(0.875));
  const edges = [...rim.map((place) => ({ place, angle: 20 })), ...mitres.map((place) => ({ place, angle: 28 }))];

  await test.step('the pointer shows the edge, a press marks it, and the rim of the block comes back', async () => {
    await expect(panel).toContainText('6 patches between 12 sharp edges of the mesh and 8 corners');
    for (const [k, { place, angle }] of edges.entries()) {
      const at = await windowOf(page, place);
      await page.mouse.move(at.x, at.y);
      await expect(card.getByRole('status')).toHaveText(`1 edge, ${angle}°: not sharp yet`);
      await expect(page.locator('.marks .hot')).toHaveCount(1);
      await page.mouse.click(at.x, at.y);
      await settled(page);
      await expect(marks).toHaveCount(k + 1);
    }
    await expect(panel).toContainText('10 patches between 20 sharp edges of the mesh and 12 corners');
    const { x, y } = await windowOf(page, [2, 0, 0.75]);
    await page.mouse.move(x - 1, y);
    await expect(card.getByRole('status')).toHaveText('1 edge, 70°: sharp by its angle');
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('one step back undoes a press, and other settings keep the marks', async () => {
    await page.keyboard.press('Control+z');
    await settled(page);
    await expect(marks).toHaveCount(7);
    await page.keyboard.press('Control+Shift+z');
    await settled(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setSetting('radius_share', 0.04));
    await settled(page);
    await expect(marks).toHaveCount(8);
    await expect(panel).toContainText('20 sharp edges of the mesh and 12 corners');
  });

  await test.step('they are copied for the command line', async () => {
    await card.getByRole('button', { name: 'Copy' }).click();
    await expect(card.getByRole('status')).toHaveText('Options copied');
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    expect(copied).toMatch(/^(--mesh-line "(-?[\d.]+,-?[\d.]+,(1|0.75) ?){2}" ?){8}$/);
  });

  await test.step('a drag turns the surface, and by keys the edge in the middle is meant', async () => {
    const { x, y } = await windowOf(page, rim[0]);
    const { yaw } = (await state(page)).view.camera;
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y, { steps: 4 });
    await page.mouse.up();
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.debug.still());
    expect((await state(page)).view.camera.yaw).not.toBe(yaw);
    await expect(marks).toHaveCount(8);
    await page.evaluate(async (target) => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.setView({ camera: { ...engine.state.value.view.camera, target, fit: false } });
      await engine.debug.still();
    }, rim[1]);
    await page.mouse.move(5, 5);
    await page.locator('#canvas-host').focus();
    await page.keyboard.press('Shift+Tab');
    await page.keyboard.press('Tab');
    await expect(card.getByRole('status')).toHaveText('1 edge, 20°: marked');
    await page.keyboard.press('Enter');
    await settled(page);
    await expect(marks).toHaveCount(7);
  });

  await test.step('Escape leaves, and the panel takes all marks off', async () => {
    await page.keyboard.press('Escape');
    await expect(card).toBeHidden();
    await panel.getByRole('button', { name: 'Unmark 7 edges' }).click();
    await settled(page);
    expect(await lines()).toBe(0);
  });
  await clean();
});

test('edges are marked by finger, and the link says that they need the file', async ({ browser }) => {
  const page = await browser.newPage({ hasTouch: true, isMobile: true });
  const { clean } = await open(page, { width: 390, height: 844, hash: COARSE });
  await choose(page, 'block.off', chamfered());
  await settled(page);
  await lookFromAbove(page);
  await page.locator('.remesh').getByRole('button', { name: 'Mark edges' }).tap();
  const { x, y } = await windowOf(page, [2 - LEAN, 0, 1]);
  // The mesh has to be there.
  await expect(page.getByRole('group', { name: 'Mark edges' }).getByRole('status')).toHaveText(/^Press/);
  await page.touchscreen.tap(x + 8, y);
  await settled(page);
  await expect(page.locator('.marks .kept')).toHaveCount(1);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await page.goto('about:blank');
  await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
  await expect(page.locator('.toast')).toContainText('Its edges are to be marked again');
  await clean();
  await page.close();
});

test('a sheet ends at its border, and a link asks for the file', async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844, hash: COARSE });
  await choose(page, 'open.off', offOf(5));
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('Holes with 4 edges at their borders are closed smoothly.');
  await page.locator('.remesh').getByRole('radio', { name: 'Kept' }).check();
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('The surface ends at its border, 1 closed curve of 4 edges.');
  expect((await report(page)).quality.area).toBeCloseTo(20, 1);
  expect((await state(page)).parameters).toEqual({ borders: 1 });
  await choose(page, 'sheet.off', sheetOf(20));
  await expect(page.getByRole('heading', { name: 'sheet.off' })).toBeVisible();
  await settled(page);
  await expect(page.locator('.remesh')).toContainText('The surface ends at its border, 1 closed curve of 80 edges.');
  await choose(page, 'open.off', offOf(5));
  await settled(page);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await page.goto('about:blank');
  await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
  await expect(page.locator('.toast')).toContainText('in a file');
  await settled(page);
  await clean();
});
