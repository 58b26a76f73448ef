/** The surface pulled by hand: with Shift, with the tool, with pins, by finger and by keyboard, and what cannot move. */
import { expect, test } from '@playwright/test';
import { afresh, atRest, open, report, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/**
 * The particle that lies farthest in a direction of the window, of those that are seen.
 * @param {Page} page @param {[number, number]} way
 * @returns {Promise<{x: number, y: number}>}
 */
const outermost = (page, way) =>
  page.evaluate(([wx, wy]) => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const { columns } = engine;
    const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
    let best = { x: 0, y: 0, far: -Infinity };
    for (let i = 0; i < columns.count; i += 1) {
      const { x, y } = engine.project(columns.shown.subarray(3 * i, 3 * i + 3));
      const far = wx * x + wy * y;
      if (far > best.far && engine.pick(x, y) === i) best = { x, y, far };
    }
    return { x: host.left + best.x, y: host.top + best.y };
  }, way);

/** Where the pins of the last pull are in the window, and whether the surface passes through them. @param {Page} page */
const grip = (page) =>
  page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
    const { holds, idle, places } = engine.grip.value;
    const spots = places.map((/** @type {number[]} */ place) => engine.project(place));
    return {
      holds,
      idle,
      spots: spots.map((/** @type {{x: number, y: number}} */ { x, y }) => ({ x: host.left + x, y: host.top + y })),
    };
  });

/** @param {Page} page @param {{x: number, y: number}} from @param {{x: number, y: number}} to */
async function drag(page, from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 6 });
  await page.mouse.up();
  await atRest(page);
}

test('the surface is pulled, and the parameters follow', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  const start = (await state(page)).parameters;
  const { yaw } = (await state(page)).view.camera;
  const right = await outermost(page, [1, 0]);
  const beyond = { x: right.x + 24, y: right.y };

  await test.step('with Shift, once', async () => {
    await page.keyboard.down('Shift');
    await drag(page, right, beyond);
    await page.keyboard.up('Shift');
    const { holds, spots } = await grip(page);
    expect(holds).toBe(true);
    expect(Math.hypot(spots[0].x - beyond.x, spots[0].y - beyond.y)).toBeLessThan(2);
    expect((await state(page)).parameters.a).toBeGreaterThan(1);
    expect((await state(page)).view.camera.yaw).toBe(yaw);
    await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(0);
    await expect(page.getByRole('button', { name: 'Grab' })).toHaveAttribute('aria-pressed', 'false');
  });

  await test.step('one step back undoes it', async () => {
    await page.keyboard.press('Control+z');
    await settled(page);
    expect((await state(page)).parameters).toEqual(start);
    await expect(page.getByRole('button', { name: 'Undo' })).toBeDisabled();
  });

  await test.step('Escape gives it up', async () => {
    await page.keyboard.down('Shift');
    await page.mouse.move(right.x, right.y);
    await page.mouse.down();
    await page.mouse.move(beyond.x, beyond.y, { steps: 6 });
    await expect.poll(async () => (await state(page)).parameters.a).toBeGreaterThan(1);
    await page.keyboard.press('Escape');
    await page.mouse.up();
    await page.keyboard.up('Shift');
    await settled(page);
    expect({ a: 1, ...(await state(page)).parameters }.a).toBe(1);
  });

  await test.step('a place that is pressed stays where it is', async () => {
    await page.getByRole('button', { name: 'Grab' }).click();
    const below = await outermost(page, [0, 1]);
    await page.mouse.click(below.x, below.y - 2);
    await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(1);
    await drag(page, right, beyond);
    const { holds, spots } = await grip(page);
    expect(holds).toBe(true);
    expect(Math.hypot(spots[0].x - below.x, spots[0].y - below.y)).toBeLessThan(6);
    expect(Math.hypot(spots[1].x - beyond.x, spots[1].y - beyond.y)).toBeLessThan(2);
    await scan(page);
  });

  await test.step('by keyboard', async () => {
    const pin = page.getByRole('slider', { name: 'Pin 2' });
    const before = await grip(page);
    await pin.focus();
    await page.keyboard.press('ArrowDown');
    await settled(page);
    const after = await grip(page);
    expect(after.holds).toBe(true);
    expect(after.spots[1].x).toBeLessThan(before.spots[1].x - 3);
    await page.keyboard.press('Delete');
    await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(1);
    // What a slider changes the pins no longer lie on.
    const slider = page.getByRole('slider', { name: /^Semi-axis a|a$/ }).first();
    await slider.focus();
    await page.keyboard.press('ArrowLeft');
    await settled(page);
    await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(0);
    await page.getByRole('button', { name: 'Done' }).click();
    await expect(page.getByRole('button', { name: 'Grab' })).toHaveAttribute('aria-pressed', 'false');
  });
  await clean();
});

test('a model is pulled around a place, and what is pinned stays', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await page.evaluate(async () => {
    const bunny = { surface: 'bunny', settings: { size_mode: 'count', count: 1500 } };
    await /** @type {any} */ (window).marchingParticles.set(bunny);
  });
  await settled(page);
  await expect(page.getByText('The surface can be pulled by hand.')).toBeVisible();
  const pulls = async () => (await state(page)).pulls;
  const top = await outermost(page, [0, -1]);
  const above = { x: top.x + 10, y: top.y - 30 };
  /** How near the nearest particle is drawn to a place of the window. */
  const nearest = (/** @type {{x: number, y: number}} */ at) =>
    page.evaluate(({ x, y }) => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
      let least = Infinity;
      for (let i = 0; i < engine.columns.count; i += 1) {
        const p = engine.project(engine.columns.shown.subarray(3 * i, 3 * i + 3));
        least = Math.min(least, Math.hypot(host.left + p.x - x, host.top + p.y - y));
      }
      return least;
    }, at);

  await test.step('with Shift, once; the points of the model are those before', async () => {
    expect(await nearest(above)).toBeGreaterThan(15);
    await page.keyboard.down('Shift');
    await drag(page, top, above);
    await page.keyboard.up('Shift');
    expect(await pulls()).toHaveLength(1);
    expect(await nearest(above)).toBeLessThan(10);
    await expect(page.getByText('1 pull on the surface.')).toBeVisible();
    await expect(page.getByRole('button', { name: 'Show points' })).toBeHidden();
    await settled(page);
    expect((await report(page)).components).toBe(1);
  });

  await test.step('a link brings it back', async () => {
    const { digest } = await report(page);
    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    await page.goto('about:blank');
    await page.goto(link.replace('#', '?backend=canvas2d#'));
    await settled(page);
    expect((await report(page)).digest).toBe(digest);
  });

  await test.step('the same pin is pulled on by the same pull, by keyboard too; undo takes each back', async () => {
    await page.getByRole('button', { name: 'Grab' }).click();
    const spot = await outermost(page, [0, -1]);
    await drag(page, spot, { x: spot.x, y: spot.y - 12 });
    expect(await pulls()).toHaveLength(2);
    const [, { by }] = await pulls();
    await page.getByRole('slider', { name: 'Pin 1' }).focus();
    await page.keyboard.press('ArrowUp');
    await settled(page);
    expect(await pulls()).toHaveLength(2);
    expect((await pulls())[1].by).not.toEqual(by);
    await page.keyboard.press('Control+z');
    await settled(page);
    await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(0);
    expect((await pulls()).length).toBeLessThanOrEqual(2);
  });

  await test.step('a pinned place stays where it is', async () => {
    await page.getByRole('button', { name: 'Reset' }).first().click();
    await settled(page);
    expect(await pulls()).toEqual([]);
    const spot = await outermost(page, [0, -1]);
    await page.mouse.click(spot.x, spot.y);
    const below = await outermost(page, [0, 1]);
    await drag(page, below, { x: below.x, y: below.y + 40 });
    const [{ at, by, reach }] = await pulls();
    const pin = await page.evaluate((spot) => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
      const index = engine.pick(spot.x - host.left, spot.y - host.top);
      return index === null ? null : [...engine.columns.positions.subarray(3 * index, 3 * index + 3)];
    }, spot);
    if (!pin) throw new Error('nothing lies under the pin');
    const away = Math.hypot(...pin.map((x, k) => x - at[k] - by[k]));
    expect(away).toBeGreaterThan(0.9 * reach);
    await scan(page);
  });
  await clean();
});

test('what cannot be pulled says so, and the picture turns instead', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  const set = (/** @type {object} */ patch) =>
    page.evaluate((patch) => /** @type {any} */ (window).marchingParticles.set(patch), patch);

  await test.step('beyond the ranges of the parameters', async () => {
    await page.getByRole('button', { name: 'Grab' }).click();
    const right = await outermost(page, [1, 0]);
    const far = { x: right.x + 150, y: right.y };
    await drag(page, right, far);
    await expect(page.getByText('The ranges of the parameters end here')).toBeVisible();
    const { holds, spots } = await grip(page);
    expect(holds).toBe(false);
    expect(far.x - spots[0].x).toBeGreaterThan(20);
    const { parameters } = await state(page);
    expect(parameters).toEqual({ a: 1.2, b: 1, c: 0.8 });
    await page.getByRole('button', { name: 'Done' }).click();
    await afresh(page);
  });

  await test.step('where no parameter moves the surface', async () => {
    await set({ formula: 'x^2 + y^2 + z^2 + 0*t = 1' });
    await page.getByRole('button', { name: 'Grab' }).click();
    const right = await outermost(page, [1, 0]);
    await drag(page, right, { x: right.x + 30, y: right.y });
    await expect(page.getByText('No parameter moves the surface here')).toBeVisible();
    expect((await grip(page)).holds).toBe(false);
    await page.getByRole('button', { name: 'Done' }).click();
  });

  await test.step('without parameters Shift moves the camera', async () => {
    await set({ formula: 'x^2 + y^2 + z^2 = 1' });
    const right = await outermost(page, [1, 0]);
    const { target } = (await state(page)).view.camera;
    await page.keyboard.down('Shift');
    await drag(page, { x: right.x - 10, y: right.y }, { x: right.x + 30, y: right.y });
    await page.keyboard.up('Shift');
    await expect.poll(async () => (await state(page)).view.camera.target).not.toEqual(target);
  });
  await clean();
});

test('particles that have followed stay, if they are to', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ flow: true }));
  const right = await outermost(page, [1, 0]);
  await page.keyboard.down('Shift');
  await drag(page, right, { x: right.x + 16, y: right.y });
  await page.keyboard.up('Shift');
  const told = async () => (await report(page))?.warnings.map((/** @type {any} */ { message }) => message).join();
  await expect.poll(told).toContain('have moved with the surface');
  await settled(page);
  expect((await report(page)).count).toBeGreaterThan(1000);
  // What a run has made is in order again, and its link makes it again.
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await settled(page);
  expect(await told()).not.toContain('have moved');
  await clean();
});

test('Escape leaves the tools that take the pointer, and the next press pins nothing', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page);
  const card = page.locator('.tool-card:visible');
  await page.getByRole('button', { name: 'Grab' }).click();
  await expect(card).toContainText('Drag the surface');
  await page.mouse.move(700, 300);
  await page.keyboard.press('Escape');
  await expect(card).toHaveCount(0);
  await page.mouse.click(700, 300);
  await expect(page.getByRole('slider', { name: /^Pin/ })).toHaveCount(0);
  await page.keyboard.press('Escape');
  await page.keyboard.press('d');
  await expect(card).toContainText('Press a particle');
  await page.keyboard.press('Escape');
  await expect(card).toHaveCount(0);
  await clean();
});
