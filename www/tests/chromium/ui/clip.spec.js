/**
 * The cutting plane and the handles of the clip box: by pointer, by finger, by keyboard, in links and in the history.
 */
import { expect, test } from '@playwright/test';
import { afresh, atRest, open, scan, settled, state, typeFormula } from './helpers.js';

/** @import { Locator, Page } from '@playwright/test' */

/** Middle of an element in the window. @param {Locator} element @returns {Promise<[number, number]>} */
async function middle(element) {
  const box = await element.boundingBox();
  if (!box) throw new Error('the element has no box');
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/**
 * Drags an element by some pixels.
 * @param {Page} page
 * @param {Locator} element
 * @param {number} dx
 * @param {number} dy
 */
async function drag(page, element, dx, dy) {
  const [x, y] = await middle(element);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx / 2, y + dy / 2, { steps: 3 });
  await page.mouse.move(x + dx, y + dy, { steps: 3 });
  await page.mouse.up();
}

/** @param {Page} page */
const openPlane = async (page) => {
  const panel = page.locator('.plane');
  if ((await panel.getAttribute('open')) === null) await panel.locator('> summary').click();
  return panel;
};
const run = (/** @type {Page} */ page) =>
  page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().progress.run);

test('the cutting plane and the faces of the box', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await test.step('what stays when the formula changes is told in the picture, and ended there', async () => {
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.setSetting('thickness', 0.1);
      engine.setPlane({ normal: [1, 0, 0], offset: 0 });
    });
    const kept = page.locator('.kept');
    await expect(kept).toContainText('Cut at x = 0');
    await typeFormula(page, '(x - 3)^2 + y^2 + z^2 = 0.5');
    await settled(page);
    await expect(kept).toContainText('Cut at x = 0, which hides everything');
    await kept.getByRole('button', { name: 'End the cut' }).click();
    await expect(kept).toHaveText('Thickness 0.1');
    expect((await state(page)).plane).toBe(null);
    // Another surface begins without it.
    await page.locator('.tile[data-surface="torus"]').click();
    await settled(page);
    await expect(kept).toBeHidden();
    expect((await state(page)).settings).toEqual({});
    await afresh(page);
  });
  await test.step('a plane cuts the picture open by keyboard alone, and nothing is sampled', async () => {
    const before = await run(page);
    const panel = await openPlane(page);
    await panel.getByRole('radio', { name: 'Off' }).focus();
    await page.keyboard.press('ArrowRight');
    // The default camera stands on the side of +x.
    await expect.poll(async () => (await state(page)).plane).toEqual({ normal: [1, 0, 0], offset: 0 });
    const slider = panel.getByRole('slider', { name: 'Position of the cutting plane' });
    await slider.focus();
    await page.keyboard.press('PageUp');
    const moved = (await state(page)).plane.offset;
    expect(moved).toBeGreaterThan(0);
    await expect(panel.locator('summary')).toContainText('x = 0.0');
    await panel.getByRole('button', { name: 'Flip' }).press('Enter');
    expect((await state(page)).plane).toEqual({ normal: [-1, 0, 0], offset: -moved });
    await panel.getByRole('radio', { name: 'x', exact: true }).focus();
    for (let i = 0; i < 3; i += 1) await page.keyboard.press('ArrowRight');
    await expect(panel.getByRole('radio', { name: 'Free' })).toBeChecked();
    const azimuth = panel.getByRole('slider', { name: 'Azimuth of the cutting plane' });
    const turned = (await state(page)).plane.normal;
    await azimuth.focus();
    for (let i = 0; i < 5; i += 1) await page.keyboard.press('PageDown');
    expect((await state(page)).plane.normal[1]).toBeLessThan(turned[1]);
    // The knob in the picture takes keys, too.
    const knob = page.getByRole('slider', { name: 'Cutting plane', exact: true });
    await knob.focus();
    const at = (await state(page)).plane.offset;
    await page.keyboard.press('ArrowDown');
    expect((await state(page)).plane.offset).toBeLessThan(at);
    await panel.getByRole('radio', { name: 'Free' }).focus();
    for (let i = 0; i < 4; i += 1) await page.keyboard.press('ArrowLeft');
    expect((await state(page)).plane).toBe(null);
    await expect(knob).toBeHidden();
    expect(await run(page)).toBe(before);
  });

  await test.step('the plane is dragged and turned in the picture, undone, and kept in links', async () => {
    await afresh(page);
    const before = await run(page);
    const panel = await openPlane(page);
    await panel.getByRole('radio', { name: 'x', exact: true }).check();
    const knob = page.getByRole('slider', { name: 'Cutting plane', exact: true });
    await expect(knob).toBeVisible();
    // Until the choice is a step of the history by itself.
    await page.waitForTimeout(900);
    const [x, y] = await middle(knob);
    const tip = await middle(page.locator('.plane-tip'));
    // Along the arrow, which is the way of the normal in the picture.
    await drag(page, knob, tip[0] - x, tip[1] - y);
    const moved = (await state(page)).plane;
    expect(moved.normal).toEqual([1, 0, 0]);
    expect(moved.offset).toBeGreaterThan(0.02);
    await page.waitForTimeout(900);
    await drag(page, page.locator('.plane-tip'), 40, -40);
    const turned = (await state(page)).plane;
    expect(Math.hypot(...turned.normal)).toBeCloseTo(1, 6);
    expect(turned.normal[2]).toBeGreaterThan(0.3);
    await expect(panel.getByRole('radio', { name: 'Free' })).toBeChecked();

    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    await page.keyboard.press('ControlOrMeta+z');
    await expect.poll(async () => (await state(page)).plane).toEqual(moved);
    await page.keyboard.press('ControlOrMeta+z');
    await page.keyboard.press('ControlOrMeta+z');
    await expect.poll(async () => (await state(page)).plane).toBe(null);
    expect(await run(page)).toBe(before);

    await open(page, { hash: new URL(link).hash });
    // The same page reads a link that differs in its fragment alone, a little later.
    await expect.poll(async () => (await state(page)).plane).not.toBe(null);
    const back = (await state(page)).plane;
    for (const k of [0, 1, 2]) expect(back.normal[k]).toBeCloseTo(turned.normal[k], 4);
    await expect(page.locator('.plane')).toHaveAttribute('open', '');
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('a face of the drawn box is dragged, and the surface follows; Escape takes it back', async () => {
    await afresh(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ box: true }));
    await atRest(page);
    const face = page.getByRole('slider', { name: 'Upper z face of the clip box' });
    await drag(page, face, 0, 70);
    await settled(page);
    const { bounds } = await state(page);
    const { field, top } = await page.evaluate(() => {
      const p = /** @type {any} */ (window).marchingParticles;
      const { positions } = p.particles();
      let top = -Infinity;
      for (let i = 2; i < positions.length; i += 3) top = Math.max(top, positions[i]);
      return { field: p.engine.field.value.bounds, top };
    });
    expect(bounds.max[2]).toBeLessThan(0.6);
    expect(field).toEqual(bounds);
    expect(top).toBeLessThanOrEqual(bounds.max[2] + 1e-4);
    await expect(face).toHaveAttribute('aria-valuetext', `z = ${Number(bounds.max[2].toPrecision(3))}`);

    const [x, y] = await middle(face);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y - 40, { steps: 3 });
    expect((await state(page)).bounds.max[2]).toBeGreaterThan(bounds.max[2]);
    await page.keyboard.press('Escape');
    await page.mouse.up();
    expect((await state(page)).bounds).toEqual(bounds);

    await face.focus();
    await page.keyboard.press('ArrowUp');
    expect((await state(page)).bounds.max[2]).toBeGreaterThan(bounds.max[2]);
    await settled(page);
    expect((await scan(page)).violations).toEqual([]);
  });
  await clean();
});

test.describe('by finger', () => {
  test.use({ hasTouch: true });
  test('a face is dragged on a phone', { tag: '@all' }, async ({ page }) => {
    await open(page, { width: 390, height: 844 });
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ box: true }));
    await atRest(page);
    const before = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.field.value.bounds);
    const { camera } = (await state(page)).view;
    const [x, y] = await middle(page.getByRole('slider', { name: 'Lower z face of the clip box' }));
    const session = await page.context().newCDPSession(page);
    const touch = (/** @type {'touchStart' | 'touchMove' | 'touchEnd'} */ type, dy = 0) =>
      session.send('Input.dispatchTouchEvent', { type, touchPoints: type === 'touchEnd' ? [] : [{ x, y: y + dy }] });
    await touch('touchStart');
    for (let i = 1; i <= 6; i += 1) await touch('touchMove', -6 * i);
    await touch('touchEnd');
    await settled(page);
    expect((await state(page)).bounds.min[2]).toBeGreaterThan(before.min[2] + 0.1);
    // The picture was not turned by the finger.
    expect((await state(page)).view.camera.yaw).toBe(camera.yaw);
  });
});
