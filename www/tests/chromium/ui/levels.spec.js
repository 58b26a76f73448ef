/** The timeline of the generation levels. */
import { expect, test } from '@playwright/test';
import { afresh, open, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page */
const level = async (page) => (await state(page)).view.level;
/** @param {Page} page */
const slider = (page) => page.getByRole('slider', { name: /^Timeline, by/ });
/** @param {Page} page @param {string} name */
const press = (page, name) => page.locator('#panel-levels').getByRole('button', { name, exact: true }).click();
/** The levels of the particles, counted. @param {Page} page @returns {Promise<number[]>} */
const fresh = (page) =>
  page.evaluate(() => {
    const { count, levels } = /** @type {any} */ (window).marchingParticles.particles();
    const n = new Array(Math.max(...levels) + 1).fill(0);
    for (let i = 0; i < count; i += 1) n[levels[i]] += 1;
    return n;
  });

/** Long enough for some levels, if they were playing. @param {Page} page */
const framesLater = (page) =>
  page.evaluate(async () => {
    for (let k = 0; k < 40; k += 1) await new Promise(requestAnimationFrame);
  });

test('the timeline of the levels', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('buttons and keys go through the levels, and the caption says how each came about', async () => {
    const made = await fresh(page);
    const last = made.length - 1;
    await expect(slider(page)).toHaveAttribute('aria-valuetext', new RegExp(`^All ${last + 1} levels`));
    await press(page, 'First level');
    expect(await level(page)).toBe(0);
    await expect(page.locator('.caption')).toContainText(`Level 0 of ${last} · 1 new, 1 so far`);
    await press(page, 'Level forward');
    await page.keyboard.press('.');
    expect(await level(page)).toBe(2);
    await expect(page.getByText('Figures describe the finished run')).toBeVisible();
    await expect(slider(page)).toHaveAttribute(
      'aria-valuetext',
      `Level 2 of ${last}: ${made[2]} particles, ${made[0] + made[1] + made[2]} so far`,
    );
    // On an ellipsoid the first levels are those of a plane: of 30 children of six particles 12 are new.
    await expect(page.locator('.caption')).toContainText('12 new (on a flat plane 12), 19 so far');
    await expect(page.locator('.caption')).toContainText(
      'Level 1 proposed 30 children: 12 added, 18 met existing particles. Drawn as placed, before relaxation.',
    );
    await page.keyboard.press(',');
    expect(await level(page)).toBe(1);
    await page.keyboard.press('<');
    await page.keyboard.press(',');
    expect(await level(page)).toBe(0);
    await page.keyboard.press('>');
    expect(await level(page)).toBe(null);
    await expect(page.locator('.caption')).not.toContainText('Level');
    // Back from the whole picture lead the relaxation steps, then the last level.
    await page.keyboard.press(',');
    expect(await state(page)).toMatchObject({ view: { level: null, step: 9 } });
    await expect(page.locator('.caption')).toContainText('Relaxation step 9 of 10');
    // Each step has its own words.
    await expect(page.locator('.caption')).toContainText(/The energy is \d[\d.]*\s?% below that of the placing\./);
    for (let k = 0; k < 9; k += 1) await page.keyboard.press(',');
    expect(await state(page)).toMatchObject({ view: { level: last, step: null } });
    await page.keyboard.press('.');
    expect(await state(page)).toMatchObject({ view: { level: null, step: 1 } });
    await page.keyboard.press('>');
    expect(await state(page)).toMatchObject({ view: { level: null, step: null } });
  });

  await test.step('a press on a bar leads to its level, and the slider is moved by keys', async () => {
    await afresh(page, { width: 1440, height: 900 });
    // After the levels come ten relaxation steps.
    const levels = (await fresh(page)).length;
    const bars = levels + 10;
    const box = await slider(page).boundingBox();
    if (!box) throw new Error('the slider has no box');
    for (const wanted of [0, 7, levels - 1]) {
      await page.mouse.click(box.x + ((wanted + 0.5) / bars) * box.width, box.y + box.height / 2);
      expect(await level(page)).toBe(wanted);
    }
    await expect(slider(page)).toBeFocused();
    await page.keyboard.press('Home');
    await page.keyboard.press('ArrowRight');
    expect(await level(page)).toBe(1);
    await page.mouse.move(box.x + 2, box.y + 8);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y - 40, { steps: 5 });
    await page.mouse.up();
    expect(await level(page)).toBe(Math.floor(bars / 2));
    await slider(page).dblclick();
    expect(await level(page)).toBe(null);
  });

  await test.step('play goes on by itself, can be paused, and ends with all levels', async () => {
    await afresh(page, { width: 1440, height: 900 });
    await page.getByRole('combobox', { name: 'Speed' }).selectOption('8');
    await press(page, 'Play');
    await expect.poll(() => level(page)).toBeGreaterThan(2);
    await page.keyboard.press('p');
    await expect(page.getByRole('button', { name: 'Play', exact: true })).toBeVisible();
    const at = await level(page);
    await framesLater(page);
    expect(await level(page)).toBe(at);
    await press(page, 'Play');
    await expect.poll(() => level(page)).toBe(null);
    await expect(page.getByRole('button', { name: 'Play', exact: true })).toBeVisible();
  });

  await test.step('the level travels in the link, and a new run shows all of its particles', async () => {
    await afresh(page);
    await press(page, 'First level');
    for (let k = 0; k < 4; k += 1) await press(page, 'Level forward');
    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    expect(JSON.parse(Buffer.from(new URL(link).hash.split('.')[2], 'base64url').toString()).view.level).toBe(4);
    await page.getByRole('button', { name: 'Run', exact: true }).first().click();
    await settled(page);
    expect(await level(page)).toBe(null);
  });

  await test.step('a setting that changes keeps the level, and a level beyond the last counts as the last', async () => {
    await afresh(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ level: 30 }));
    await expect(page.locator('.caption')).toContainText('Level 30 of');
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setSetting('radius_share', 0.02));
    await settled(page);
    const last = (await fresh(page)).length - 1;
    expect(last).toBeLessThan(30);
    await expect(page.locator('.caption')).toContainText(`Level ${last} of ${last}`);
    expect(await level(page)).toBe(30);
  });

  await test.step('an adaptive run has levels of its own, without a plane to compare with', async () => {
    await afresh(page);
    await page.getByRole('radio', { name: 'Adaptive' }).check();
    await settled(page);
    await press(page, 'First level');
    await press(page, 'Level forward');
    await press(page, 'Level forward');
    await expect(page.locator('.caption')).toContainText(/Level 1 proposed \d+ children: \d+ added/);
    await expect(page.locator('.caption')).not.toContainText('flat plane');
  });

  await test.step('without a surface there is nothing to step through', async () => {
    await afresh(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setFormula('x^2 + 1'));
    await settled(page);
    await expect(page.locator('.levels-range')).toBeDisabled();
    await page.keyboard.press('<');
    expect(await level(page)).toBe(null);
  });

  await test.step('the start of the front is turned to the eye', async () => {
    await page.emulateMedia({ reducedMotion: 'reduce' });
    await afresh(page);
    expect(await facing(page)).toBeLessThan(0.3);
    await press(page, 'First level');
    await expect.poll(() => facing(page)).toBeGreaterThan(0.8);
  });
  await clean();
});

test('nothing plays of itself, whatever the link says', { tag: '@all' }, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await open(page, { hash: `#v1.j.${Buffer.from(JSON.stringify({ view: { level: 3 } })).toString('base64url')}` });
  await expect(slider(page)).toHaveAttribute('aria-valuetext', /^Level 3 of/);
  await expect(page.getByRole('button', { name: 'Play', exact: true })).toBeVisible();
  await framesLater(page);
  expect(await level(page)).toBe(3);
});

test('the charts of the levels', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1280, height: 800 });
  await test.step('the charts are places of the timeline, with tables as their twins', async () => {
    const last = (await fresh(page)).length - 1;
    await page.getByRole('button', { name: 'Charts' }).click();
    const chart = page.getByRole('img', { name: /^New particles in each of/ });
    const box = await chart.boundingBox();
    if (!box) throw new Error('the chart has no box');
    await page.mouse.click(box.x + (7.5 / (last + 1)) * box.width, box.y + box.height / 2);
    expect(await level(page)).toBe(7);
    const energy = await page.getByRole('img', { name: /^Energy per particle over 10 relaxation steps/ }).boundingBox();
    if (!energy) throw new Error('the chart has no box');
    await page.mouse.click(energy.x + (4.5 / 11) * energy.width, energy.y + 5);
    expect((await state(page)).view).toMatchObject({ level: null, step: 4 });
    // A drag goes on to where nothing of the relaxation has happened: the last level as it was placed.
    await page.mouse.move(energy.x + energy.width / 2, energy.y + 5);
    await page.mouse.down();
    await page.mouse.move(energy.x + 1, energy.y + 5, { steps: 4 });
    await page.mouse.up();
    expect((await state(page)).view).toMatchObject({ level: last, step: null });
    await expect(page.getByRole('img', { name: /^Largest move in each of 10 relaxation steps/ })).toBeVisible();
    // No explanation lies on their words.
    const charts = await page.getByRole('group', { name: 'Charts' }).boundingBox();
    for (const anchor of ['.tile[data-surface="sphere"]', '.levels-track', '.setting[data-setting="size_mode"]']) {
      await page.locator(anchor).hover();
      const tip = page.locator('.explain');
      await expect(tip).toBeVisible();
      const own = await tip.boundingBox();
      if (!own || !charts) throw new Error('there is no box');
      const isBeside = own.x + own.width <= charts.x || own.y + own.height <= charts.y;
      expect(isBeside, anchor).toBe(true);
      await page.mouse.move(5, 5);
      await expect(tip).toBeHidden();
    }
    await page.getByText('As tables').click();
    await expect(page.getByRole('table', { name: 'Levels' }).getByRole('row')).toHaveCount(last + 2);
    await expect(page.getByRole('table', { name: 'Relaxation' }).getByRole('row')).toHaveCount(12);
    expect((await scan(page)).violations).toEqual([]);
    await page.getByText('As tables').click();
    await page.getByRole('button', { name: 'Charts' }).click();
    await expect(chart).toBeHidden();
  });

  await test.step('distances to the nearest are those of what is shown, and neighbours those of the end', async () => {
    await afresh(page, { width: 1280, height: 800 });
    await page.getByRole('button', { name: 'Charts' }).click();
    const nearest = page.getByRole('img', { name: /to their nearest, in 2r/ });
    const degree = page.getByRole('img', { name: /^Particles by their neighbours at the end of the run/ });
    await expect(
      page.getByText(
        /^[\d,]+ particles\. A hexagonal lattice of these discs would have [\d,]+ on this area.* there are 1\d\d\.\d% of that\.$/,
      ),
    ).toBeVisible();
    const six = await page.evaluate(
      () => /** @type {any} */ (window).marchingParticles.report().quality.six_neighbours,
    );
    await expect(degree).toHaveAttribute('aria-label', new RegExp(`six: ${(100 * six).toFixed(1)}`));
    const deviation = async () => Number(/± ([\d.]+)/.exec((await nearest.getAttribute('aria-label')) ?? '')?.[1]);
    await expect(nearest).toHaveAttribute('aria-label', /^Distance of all [\d,]+ particles to/);
    const end = await deviation();
    // Six particles around a seed: all at 2r from it.
    await press(page, 'First level');
    await expect(page.locator('.chart', { hasText: 'Nearest, in 2r' })).toContainText('Known of two to');
    await press(page, 'Level forward');
    await expect(nearest).toHaveAttribute('aria-label', /up to level 1 to their nearest, in 2r: (1\.000|0\.99\d)\s±/);
    await press(page, 'All levels');
    for (let k = 0; k < 10; k += 1) await press(page, 'Level back');
    // As they were placed the distances are less even.
    await expect(nearest).toHaveAttribute('aria-label', /up to level/);
    expect(await deviation()).toBeGreaterThan(1.2 * end);
    await page.getByText('As tables').click();
    await expect(page.getByRole('table', { name: 'Neighbours' }).getByRole('row')).toHaveCount(8);
    expect((await scan(page)).violations).toEqual([]);
  });
  await clean();
});

/** Cosine between the normal of the first particle and the direction to the eye. @param {Page} page */
const facing = (page) =>
  page.evaluate(() => {
    const { state, particles } = /** @type {any} */ (window).marchingParticles;
    const { yaw, pitch } = state.view.camera;
    const [x, y, z] = particles().normals;
    return x * Math.cos(yaw) * Math.cos(pitch) + y * Math.sin(yaw) * Math.cos(pitch) + z * Math.sin(pitch);
  });

test('a link to an early level from behind turns to it, and one that goes too far says so', { tag: '@all' }, async ({
  page,
}) => {
  const link = (/** @type {object} */ view) => `#v1.j.${Buffer.from(JSON.stringify({ view })).toString('base64url')}`;
  await open(page, { hash: link({ level: 1 }) });
  await expect.poll(() => facing(page)).toBeGreaterThan(0.3);
  const { camera } = (await state(page)).view;
  await page.goto('about:blank');
  await open(page, {
    hash: link({ level: 1, camera: { ...camera, fit: false, yaw: camera.yaw + Math.PI, pitch: -camera.pitch } }),
  });
  await expect.poll(() => facing(page)).toBeGreaterThan(0.3);
  // What is said goes after some seconds, on a slow machine before the figures are there.
  const says = (/** @type {RegExp} */ text, /** @type {object} */ view) =>
    Promise.all([expect(page.getByText(text)).toBeVisible(), open(page, { hash: link(view) })]);
  await page.goto('about:blank');
  await says(/^The link names level 999\. The last one, \d+, is shown\.$/, { level: 999 });
  await page.goto('about:blank');
  await says(/^The link names relaxation step 99\. The last one, 10, is shown\.$/, { step: 99 });
});

test('the timeline is whole in every window, and axe finds nothing', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  for (const [width, height] of /** @type {const} */ ([
    [1440, 900],
    [820, 1180],
    [844, 390],
    [390, 844],
    [320, 640],
  ])) {
    await page.setViewportSize({ width, height });
    const tab = page.getByRole('navigation', { name: 'Panels' }).getByRole('button', { name: 'Levels' });
    // The panel stays open when a window that has tabs is resized.
    if ((await tab.isVisible()) && !(await page.locator('#levels-body').isVisible())) await tab.click();
    await press(page, 'First level');
    for (let k = 0; k < 5; k += 1) await press(page, 'Level forward');
    const boxes = await page.locator('#levels-body').evaluate((body) =>
      [...body.children].map((child) => {
        const { left, right, top, bottom } = child.getBoundingClientRect();
        return { left, right, top, bottom };
      }),
    );
    for (const [k, a] of boxes.entries()) {
      expect(a.left).toBeGreaterThanOrEqual(0);
      expect(a.right).toBeLessThanOrEqual(width);
      for (const b of boxes.slice(k + 1))
        expect(
          a.right <= b.left + 0.5 || b.right <= a.left + 0.5 || a.bottom <= b.top + 0.5 || b.bottom <= a.top + 0.5,
        ).toBe(true);
    }
    expect((await scan(page)).violations).toEqual([]);
  }
  await clean();
});
