/** The page in a browser with WebGPU (in software). */
import { expect, test } from '@playwright/test';
import { counts, expectSurface, open, picture, spots, status } from './browser.js';

test('WebGPU draws the surface and the points of a model; a lost device is rebuilt, and at the fourth loss WebGL2 takes over', async ({
  page,
}) => {
  const { errors } = await open(page);
  const set = (/** @type {object} */ patch) =>
    page.evaluate((p) => /** @type {any} */ (window).marchingParticles.set(p), patch);
  await expectSurface(page);
  const { state } = await page.evaluate(() => ({ state: /** @type {any} */ (window).marchingParticles.state }));

  await set({ surface: 'bunny', settings: { radius_share: 0.015 }, view: { colour: 'plain' } });
  const dotted = await spots(page);
  await set({ view: { points: false } });
  expect(dotted.black).toBeGreaterThan((await spots(page)).black + 100);
  await set(state);
  expect(errors).toEqual([]);

  const before = await picture(page);
  const lose = async (/** @type {number} */ opened) => {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
    await expect.poll(async () => (await counts(page)).opened).toBe(opened);
  };
  await lose(2);
  await expect.poll(async () => (await status(page)).notice?.text).toContain('is back');
  expect((await status(page)).backend).toBe('webgpu');
  expect(await picture(page)).toEqual(before);
  for (let k = 3; k <= 5; k += 1) await lose(k);
  expect((await status(page)).backend).toBe('webgl2');
  await expectSurface(page);
  await expect(page.locator('#canvas-host canvas')).toHaveCount(1);
});

test('a WebGPU of the processor alone is no graphics card: who asks for nothing gets the painter', {
  tag: '@all',
}, async ({ page }) => {
  await open(page, undefined, { asks: null, drawnBy: 'canvas2d' });
  await expectSurface(page);
});

test('without navigator.gpu WebGL2 draws', { tag: '@all' }, async ({ page }) => {
  await page.addInitScript(() => {
    Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined });
  });
  await open(page, undefined, { asks: 'webgpu', drawnBy: 'webgl2' });
  await expectSurface(page);
});

test('a shader that the driver refuses is no end of the page: WebGL2 takes over, and a notice has what the driver says', {
  tag: '@all',
}, async ({ page }) => {
  await page.addInitScript(() => {
    const { prototype } = /** @type {any} */ (window).GPUDevice;
    const make = prototype.createShaderModule;
    prototype.createShaderModule = function (/** @type {{code: string}} */ descriptor) {
      return make.call(this, { ...descriptor, code: `${descriptor.code}\nfn broken( {` });
    };
  });
  const { errors } = await open(page, undefined, { asks: 'webgpu', drawnBy: 'webgl2' });
  await expectSurface(page);
  // It is found after the device has opened, and so it is said.
  const { notice } = await status(page);
  if (notice) expect(notice).toMatchObject({ id: 'fallback', details: expect.stringMatching(/webgpu: ./) });
  expect(errors.filter((text) => /panicked|unreachable/.test(text))).toEqual([]);
});

test('a call that the device refuses while it draws is no panic either', { tag: '@all' }, async ({ page }) => {
  await open(page);
  await page.evaluate(() => {
    // A buffer that is too small for what is written into it.
    const { prototype } = /** @type {any} */ (window).GPUDevice;
    const make = prototype.createBuffer;
    prototype.createBuffer = function (/** @type {{size: number, usage: number}} */ descriptor) {
      const isOfInstances = (descriptor.usage & 0x20) !== 0;
      return make.call(this, { ...descriptor, size: isOfInstances ? 16 : descriptor.size });
    };
  });
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({ surface: 'torus', settings: { radius_share: 0.003 } }),
  );
  await expect.poll(async () => (await status(page)).backend).toBe('webgl2');
  expect((await status(page)).notice).toMatchObject({ id: 'fallback' });
  await expectSurface(page);
});
