/** The brush: places painted finer and coarser by mouse, by finger and by keyboard, undone, kept in the link, cleared. */
import { expect, test } from '@playwright/test';
import { link } from '../engine/browser.js';
import { afresh, atRest, open, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const SPHERE = link({ surface: 'sphere', settings: { radius_share: 0.02 } });

/** The middle of the picture in the window. @param {Page} page */
const middle = (page) =>
  page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const host = document.querySelector('#canvas-host')?.getBoundingClientRect() ?? new DOMRect();
    const { x, y } = engine.project(engine.state.value.view.camera.target);
    return { x: host.left + x, y: host.top + y };
  });

/** The number of particles, and their smallest and largest radius. @param {Page} page */
const sizes = (page) =>
  page.evaluate(() => {
    const { columns } = /** @type {any} */ (window).marchingParticles.engine;
    const radii = [...columns.radii.subarray(0, columns.count)];
    return { count: columns.count, least: Math.min(...radii), most: Math.max(...radii) };
  });

/** @param {Page} page */
const places = async (page) => ((await state(page)).settings.brush ?? '').split(';').filter(Boolean);

/** @param {Page} page */
async function takeBrush(page) {
  if ((await page.getByRole('button', { name: 'Advanced' }).getAttribute('aria-expanded')) === 'false')
    await page.getByRole('button', { name: 'Advanced' }).click();
  await page.getByRole('button', { name: 'Paint', exact: true }).click();
  await expect(page.getByRole('group', { name: 'Brush' })).toBeVisible();
}

test('the brush paints, undoes, erases, is kept in the link and cleared', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { hash: SPHERE });
  const plain = await sizes(page);
  const { yaw } = (await state(page)).view.camera;
  await takeBrush(page);
  const card = page.getByRole('group', { name: 'Brush' });
  const { x, y } = await middle(page);

  await test.step('a drag over the surface makes it finer there, and does not turn it', async () => {
    await page.mouse.move(x - 60, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y, { steps: 8 });
    await expect(page.locator('.marks .dab.finer')).not.toHaveCount(0);
    expect(await places(page), 'sampled once the stroke ends').toHaveLength(0);
    await page.mouse.up();
    await settled(page);
    expect((await places(page)).length).toBeGreaterThan(1);
    const fine = await sizes(page);
    expect(fine.count).toBeGreaterThan(plain.count);
    expect(fine.least / plain.least).toBeCloseTo(0.5, 1);
    expect((await state(page)).view.camera.yaw).toBe(yaw);
  });

  await test.step('coarser ones lie over it; one step back undoes a stroke', async () => {
    const before = await places(page);
    await card.getByRole('radio', { name: '2' }).check();
    await page.mouse.click(x, y + 90);
    await settled(page);
    expect((await places(page)).at(-1)).toMatch(/ 2$/);
    await expect(page.locator('.marks .dab.coarser')).not.toHaveCount(0);
    await page.keyboard.press('Control+z');
    await settled(page);
    expect(await places(page)).toEqual(before);
  });

  await test.step('the link keeps it', async () => {
    const before = await places(page);
    const hash = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.link());
    await afresh(page, { hash });
    expect(await places(page)).toEqual(before);
  });

  await test.step('Escape gives a stroke up, then the brush', async () => {
    const before = await places(page);
    await takeBrush(page);
    await page.locator('.canvas-host').focus();
    const now = await middle(page);
    await page.mouse.move(now.x, now.y - 90);
    await page.mouse.down();
    await page.mouse.move(now.x + 40, now.y - 90, { steps: 4 });
    await page.keyboard.press('Escape');
    await page.mouse.up();
    expect(await places(page)).toEqual(before);
    await expect(card).toBeVisible();
    await page.keyboard.press('Escape');
    await expect(card).toBeHidden();
  });

  await test.step('Enter paints the middle of the picture; the eraser takes away what it touches', async () => {
    await page.getByRole('button', { name: /^Clear \d+ places/ }).click();
    await settled(page);
    expect((await sizes(page)).count).toBe(plain.count);
    await takeBrush(page);
    await page.locator('.canvas-host').focus();
    await page.keyboard.press('Enter');
    await settled(page);
    expect(await places(page)).toHaveLength(1);
    await card.getByRole('radio', { name: 'Erase' }).check();
    await card.getByRole('button', { name: 'Middle' }).click();
    await settled(page);
    expect(await places(page)).toHaveLength(0);
  });

  await test.step('one press clears all; adaptive sizes are not painted, and the button says why', async () => {
    await card.getByRole('radio', { name: '½' }).check();
    await card.getByRole('button', { name: 'Middle' }).click();
    await settled(page);
    await card.getByRole('button', { name: 'Clear' }).click();
    await settled(page);
    expect(await places(page)).toHaveLength(0);
    await page.getByRole('radio', { name: 'Adaptive' }).check();
    await expect(card).toBeHidden();
    const paint = page.getByRole('button', { name: 'Paint', exact: true });
    await expect(paint).toHaveAttribute('aria-disabled', 'true');
    await paint.click({ force: true });
    await expect(page.locator('#explain')).toContainText('adaptive sizes, which follow the curvature');
  });
  await clean();
});

test.describe('on a phone', () => {
  test.use({ hasTouch: true });

  test('a finger paints the surface that the card leaves free', { tag: '@all' }, async ({ page }) => {
    const { clean } = await open(page, { width: 390, height: 844, hash: SPHERE });
    await page.getByRole('navigation', { name: 'Panels' }).getByRole('button', { name: 'Sampling' }).click();
    await takeBrush(page);
    const { x, y } = await middle(page);
    const card = await page.getByRole('group', { name: 'Brush' }).boundingBox();
    expect(card && card.x + card.width).toBeLessThanOrEqual(390);
    expect(card && card.y + card.height).toBeLessThan(y);
    const finger = await page.context().newCDPSession(page);
    const touch = (/** @type {'touchStart' | 'touchMove' | 'touchEnd'} */ type, /** @type {number[]} */ ...at) =>
      finger.send('Input.dispatchTouchEvent', { type, touchPoints: at.length ? [{ x: at[0], y: at[1] }] : [] });
    await touch('touchStart', x - 40, y);
    for (let k = 1; k <= 8; k += 1) await touch('touchMove', x - 40 + 10 * k, y);
    await touch('touchEnd');
    await atRest(page);
    await settled(page);
    expect((await places(page)).length).toBeGreaterThan(1);
    await page.getByRole('button', { name: 'Done' }).click();
    await clean();
  });
});
