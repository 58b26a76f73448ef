/**
 * The generation levels in the picture: what is hidden, muted and picked, and what it costs to go from one to another.
 */
import { expect, test } from '@playwright/test';
import { atRest, coarse, counts, link, open, picture } from './browser.js';

/** @import { Page } from '@playwright/test' */

/**
 * Shows a level, and waits for what is drawn of the surface to come.
 * @param {Page} page @param {number | null} level
 */
async function show(page, level) {
  await page.evaluate((k) => /** @type {any} */ (window).marchingParticles.engine.setView({ level: k }), level);
  await page.waitForFunction(() => {
    const { backend, mesh } = /** @type {any} */ (window).marchingParticles.status();
    const { level: now } = /** @type {any} */ (window).marchingParticles.state.view;
    return backend === 'canvas2d' || now === null || mesh !== null;
  });
}

/**
 * Faces the seed, so that the first levels are in front, and holds the camera, which would frame them.
 * @param {Page} page
 */
const faceSeed = (page) =>
  page.evaluate(() => {
    const p = /** @type {any} */ (window).marchingParticles;
    const [x, y, z] = p.particles().normals;
    p.engine.setView({
      camera: {
        ...p.state.view.camera,
        yaw: Math.atan2(y, x),
        pitch: Math.asin(Math.max(-1, Math.min(1, z))),
        fit: false,
      },
    });
  });

export const suite = () => {
  test('a level hides the later ones and mutes the earlier ones', async ({ page }) => {
    await open(page);
    await faceSeed(page);
    const drawn = [];
    for (const level of [0, 3, 8, null]) {
      await show(page, level);
      // The surface to come is grey.
      drawn.push((await picture(page)).coloured);
    }
    for (let k = 1; k < drawn.length; k += 1) expect(drawn[k]).toBeGreaterThan(1.5 * drawn[k - 1]);
    // The seed is in the middle of what is drawn: pure in its own level, paler in the next.
    const pale = async () => {
      const { middle, corner } = await picture(page);
      return Math.hypot(...[0, 1, 2].map((k) => middle[k] - corner[k]));
    };
    await page.evaluate(() => {
      const p = /** @type {any} */ (window).marchingParticles;
      const [x, y, z] = p.particles().positions;
      p.engine.setView({ size: 1.5, camera: { ...p.state.view.camera, target: [x, y, z], fit: false } });
    });
    await show(page, 0);
    const newest = await pale();
    await show(page, 1);
    const older = await pale();
    expect(older).toBeLessThan(0.8 * newest);
    expect(older).toBeGreaterThan(0.2 * newest);
  });

  test('to go from level to level costs a frame each, and nothing is told to the device again', async ({ page }) => {
    await open(page);
    await atRest(page);
    await show(page, 1);
    await atRest(page);
    const before = await counts(page);
    for (const level of [2, 3, 7]) {
      const { frames } = await counts(page);
      await show(page, level);
      await expect.poll(async () => (await counts(page)).frames).toBe(frames + 1);
    }
    await atRest(page);
    const after = await counts(page);
    expect(after.frames).toBe(before.frames + 3);
    expect(after.uploads).toBe(before.uploads);
  });

  test('a front that grows is framed as it is, until a hand takes the camera', async ({ page }) => {
    await open(page);
    const distance = () =>
      page.evaluate(() => /** @type {any} */ (window).marchingParticles.state.view.camera.distance);
    const distances = [];
    for (const level of [2, 6, 10, null]) {
      await show(page, level);
      await atRest(page);
      distances.push(await distance());
    }
    for (let k = 1; k < distances.length; k += 1) expect(distances[k]).toBeGreaterThan(distances[k - 1]);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.zoom(1.25));
    await atRest(page);
    const held = await distance();
    await show(page, 2);
    await atRest(page);
    expect(await distance()).toBe(held);
  });

  test('what is hidden is not picked', async ({ page }) => {
    await open(page);
    const outcome = await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
      p.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
      const [x, y, z] = p.particles().normals;
      // The seed on the far side.
      p.engine.setView({
        camera: {
          ...p.state.view.camera,
          yaw: Math.atan2(y, x) + Math.PI,
          pitch: -Math.asin(Math.max(-1, Math.min(1, z))),
        },
      });
      const at = () => p.engine.pick(host.clientWidth / 2, host.clientHeight / 2);
      const { levels } = p.particles();
      const near = at();
      p.engine.setView({ level: 5 });
      const through = at();
      return { near: levels[near], through: through === null ? null : levels[through] };
    });
    expect(outcome.near).toBeGreaterThan(5);
    expect(outcome.through ?? 0).toBeLessThanOrEqual(5);
  });

  test('a link with a level shows it, also after the device was lost', async ({ page }) => {
    // On the side of the seed.
    const camera = { target: [0, 0, 0], distance: 5, yaw: 0.62 + Math.PI, pitch: -0.42, fit: false };
    await open(page, `./${link({ ...coarse, view: { level: 4, camera } })}`);
    const before = await picture(page);
    expect(before.coloured).toBeGreaterThan(0.002);
    await show(page, null);
    expect((await picture(page)).coloured).toBeGreaterThan(2 * before.coloured);
    await show(page, 4);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
    await expect.poll(async () => (await counts(page)).opened).toBe(2);
    expect((await picture(page)).coloured).toBeCloseTo(before.coloured, 2);
  });
};
