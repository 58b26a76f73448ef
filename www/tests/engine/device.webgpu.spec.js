/** The page in a browser with WebGPU (in software). */
import { expect, test } from '@playwright/test';
import { counts, expectSurface, open, picture, spots, status } from './browser.js';

test('WebGPU draws the surface', async ({ page }) => {
  const { errors } = await open(page);
  expect((await status(page)).backend).toBe('webgpu');
  await expectSurface(page);
  expect(errors).toEqual([]);
});

test('a lost device is rebuilt from the columns, with the same picture', async ({ page }) => {
  await open(page);
  const before = await picture(page);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
  await expect.poll(async () => (await counts(page)).opened).toBe(2);
  await expect.poll(async () => (await status(page)).notice?.text).toContain('is back');
  expect((await status(page)).backend).toBe('webgpu');
  expect(await picture(page)).toEqual(before);
});

test('after three losses in a row WebGL2 takes over, on a new canvas', async ({ page }) => {
  await open(page);
  for (let k = 2; k <= 5; k += 1) {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
    await expect.poll(async () => (await counts(page)).opened).toBe(k);
  }
  expect((await status(page)).backend).toBe('webgl2');
  await expectSurface(page);
  await expect(page.locator('#canvas-host canvas')).toHaveCount(1);
});

test('without navigator.gpu WebGL2 draws', async ({ page }) => {
  await page.addInitScript(() => {
    Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined });
  });
  await open(page);
  expect((await status(page)).backend).toBe('webgl2');
  await expectSurface(page);
});

test('a shader that the driver refuses is no end of the page: WebGL2 takes over, and a notice has what the driver says', async ({
  page,
}) => {
  await page.addInitScript(() => {
    const { prototype } = /** @type {any} */ (window).GPUDevice;
    const make = prototype.createShaderModule;
    prototype.createShaderModule = function (/** @type {{code: string}} */ descriptor) {
      return make.call(this, { ...descriptor, code: `${descriptor.code}\nfn broken( {` });
    };
  });
  const { errors } = await open(page);
  await expect.poll(async () => (await status(page)).backend).toBe('webgl2');
  await expectSurface(page);
  // It is found after the device has opened, and so it is said.
  const { notice } = await status(page);
  if (notice) expect(notice).toMatchObject({ id: 'fallback', details: expect.stringMatching(/webgpu: ./) });
  expect(errors.filter((text) => /panicked|unreachable/.test(text))).toEqual([]);
});

test('a call that the device refuses while it draws is no panic either', async ({ page }) => {
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

test('WebGPU draws the points of a model', async ({ page }) => {
  await open(page);
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({
      surface: 'bunny',
      settings: { radius_share: 0.015 },
      view: { colour: 'plain' },
    }),
  );
  const dotted = await spots(page);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ points: false }));
  expect(dotted.black).toBeGreaterThan((await spots(page)).black + 100);
});
