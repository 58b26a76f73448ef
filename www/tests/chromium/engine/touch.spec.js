/**
 * Fingers on the picture: a tap chooses a particle, two fingers zoom and carry the surface, and the page itself stays
 * as it is.
 */
import { expect, test } from '@playwright/test';
import { atRest, open } from './browser.js';

/** @import { Page } from '@playwright/test' */

test.use({ hasTouch: true, viewport: { width: 480, height: 640 } });

/** @param {Page} page @returns {Promise<any>} */
const camera = (page) =>
  page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.state.value.view.camera);

/**
 * A place of the picture that no panel covers and where a particle is.
 * @param {Page} page
 * @returns {Promise<[number, number]>}
 */
const place = (page) =>
  page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
    const { left, top } = host.getBoundingClientRect();
    for (let v = 0.15; v < 0.7; v += 0.02) {
      for (let u = 0.3; u < 0.7; u += 0.02) {
        const [x, y] = [Math.round(innerWidth * u), Math.round(innerHeight * v)];
        const free = [
          [0, 0],
          [70, 0],
          [-70, 0],
        ].every(([dx, dy]) => host.contains(document.elementFromPoint(x + dx, y + dy)));
        if (free && engine.pick(x - left, y - top) !== null) return [x, y];
      }
    }
    throw new Error('no free place with a particle');
  });

/**
 * Two fingers, from and to these distances from the middle, in steps.
 * @param {Page} page
 * @param {[number, number]} at
 * @param {number} fromPx
 * @param {number} toPx
 * @param {[number, number]} [carry]  way of the middle
 */
async function pinch(page, at, fromPx, toPx, carry = [0, 0]) {
  const session = await page.context().newCDPSession(page);
  const fingers = (/** @type {number} */ t) =>
    [-1, 1].map((side, id) => ({
      id,
      x: at[0] + carry[0] * t + side * (fromPx + (toPx - fromPx) * t),
      y: at[1] + carry[1] * t,
    }));
  await session.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: fingers(0) });
  for (let k = 1; k <= 10; k += 1)
    await session.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: fingers(k / 10) });
  await session.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  await session.detach();
}

/** Shows the whole surface again. @param {Page} page */
async function reset(page) {
  await page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.dismissHover();
    engine.fit();
  });
  await atRest(page);
}

test('fingers choose a particle, zoom, carry and turn', { tag: '@all' }, async ({ page }) => {
  await open(page);
  await test.step('a tap on a particle tells of it, and a tap on the ground takes that away', async () => {
    const at = await place(page);
    const before = await camera(page);
    await page.touchscreen.tap(...at);
    const hover = () => page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.hover.value);
    await expect.poll(hover).not.toBe(null);
    const seen = /** @type {any} */ (await hover());
    expect(Math.hypot(...seen.normal)).toBeCloseTo(1, 4);
    expect(seen.radius).toBeGreaterThan(0);
    expect(await camera(page)).toEqual(before);
    const corner = await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
      const { left, top } = host.getBoundingClientRect();
      for (let y = 4; y < innerHeight; y += 6) {
        for (let x = 4; x < innerWidth; x += 6)
          if (host.contains(document.elementFromPoint(x, y)) && engine.pick(x - left, y - top) === null) return [x, y];
      }
      throw new Error('no free ground');
    });
    await page.touchscreen.tap(corner[0], corner[1]);
    await expect.poll(hover).toBe(null);
  });

  await test.step('two fingers that part come nearer, by as much as they part, and the page does not zoom', async () => {
    await reset(page);
    const at = await place(page);
    const before = await camera(page);
    await pinch(page, at, 30, 60);
    await expect.poll(async () => (await camera(page)).distance / before.distance).toBeCloseTo(0.5, 2);
    const near = await camera(page);
    expect(near.fit).toBe(false);
    expect([near.yaw, near.pitch]).toEqual([before.yaw, before.pitch]);
    expect(await page.evaluate(() => window.visualViewport?.scale)).toBe(1);
    await pinch(page, at, 60, 30);
    await expect.poll(async () => (await camera(page)).distance).toBeGreaterThan(near.distance * 1.7);
  });

  await test.step('two fingers that keep their distance carry the surface along', async () => {
    await reset(page);
    const at = await place(page);
    const before = await camera(page);
    await pinch(page, at, 40, 40, [0, 50]);
    await expect.poll(async () => (await camera(page)).target).not.toEqual(before.target);
    const after = await camera(page);
    expect(after.distance / before.distance).toBeCloseTo(1, 2);
    // Fingers that go down take the surface down: the target goes up.
    expect(after.target[2]).toBeGreaterThan(before.target[2]);
  });

  await test.step('a finger lifted from a pinch leaves the other one turning, without a jump', async () => {
    await reset(page);
    const before = await camera(page);
    // The browser's protocol lifts all fingers or none, so these are the page's own events.
    const fire = (/** @type {[string, number, number][]} */ events) =>
      page.evaluate((list) => {
        const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
        for (const [type, pointerId, clientX] of list) {
          host.dispatchEvent(
            new PointerEvent(type, {
              pointerId,
              clientX,
              clientY: 200,
              button: type === 'pointermove' ? -1 : 0,
              pointerType: 'touch',
              bubbles: true,
            }),
          );
        }
      }, events);
    await fire([
      ['pointerdown', 5, 200],
      ['pointerdown', 6, 280],
      ['pointermove', 5, 180],
      ['pointermove', 6, 300],
      ['pointerup', 6, 300],
    ]);
    await expect.poll(async () => (await camera(page)).distance).toBeLessThan(before.distance * 0.8);
    const held = await camera(page);
    expect(held.yaw).toBe(before.yaw);
    await fire([['pointermove', 5, 200]]);
    await expect.poll(async () => (await camera(page)).yaw).not.toBe(held.yaw);
    const turned = await camera(page);
    expect(turned.distance).toBe(held.distance);
    // 20 pixels of 480, at 0.9 π for the whole side.
    expect(Math.abs(turned.yaw - held.yaw)).toBeCloseTo((20 / 480) * 0.9 * Math.PI, 3);
    await fire([['pointerup', 5, 200]]);
  });
});
