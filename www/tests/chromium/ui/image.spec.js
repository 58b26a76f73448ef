/** Files of three-dimensional images on the page. */
import { gzipSync } from 'node:zlib';
import { expect, test } from '@playwright/test';
import { COARSE, open, report, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const SIDE = 32;

/** The bytes of a NIfTI file of voxels of 16 bits, half a unit apart. @param {(p: number[]) => number} value */
function niftiOf(value) {
  const header = Buffer.alloc(352);
  const view = new DataView(header.buffer, header.byteOffset);
  view.setInt32(0, 348, true);
  for (const [k, n] of [3, SIDE, SIDE, SIDE, 1, 1, 1, 1].entries()) view.setInt16(40 + 2 * k, n, true);
  view.setInt16(70, 4, true);
  view.setInt16(72, 16, true);
  for (const [k, length] of [1, 0.5, 0.5, 0.5].entries()) view.setFloat32(76 + 4 * k, length, true);
  view.setFloat32(108, 352, true);
  view.setFloat32(112, 1, true);
  header.write('n+1\0', 344, 'latin1');
  const voxels = new Int16Array(SIDE ** 3);
  for (let at = 0; at < voxels.length; at += 1)
    voxels[at] = value([at % SIDE, Math.floor(at / SIDE) % SIDE, Math.floor(at / SIDE ** 2)]);
  return Buffer.concat([header, Buffer.from(voxels.buffer)]);
}

const fromMiddle = (/** @type {number[]} */ p) => Math.hypot(...p.map((v) => v - 15.3));
/** A ball, bright in the dark: 0 lies at ten voxels from its middle, so at 5 units. */
const BALL = gzipSync(niftiOf((p) => Math.round(100 * (10 - fromMiddle(p)))));
/** A ball within a shell, as labels. */
const BODIES = niftiOf((p) => (fromMiddle(p) < 6 ? 2 : fromMiddle(p) < 11 ? 5 : 0));

/** @param {Page} page @param {string} name @param {Buffer} buffer */
const choose = (page, name, buffer) =>
  page.locator('input[type=file]').setInputFiles({ name, mimeType: 'application/octet-stream', buffer });

const sliderOf = (/** @type {Page} */ page) => page.getByRole('spinbutton', { name: 'Iso value iso, number' });

test('an image is sampled, follows its iso value, and what is no image leaves it as it is', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  const image = page.locator('.image');
  await choose(page, 'ball.nii.gz', BALL);
  await expect(page.getByRole('heading', { name: 'ball.nii.gz' })).toBeVisible();
  await settled(page);

  await test.step('its voxels are told, and an iso value on the slider moves the surface', async () => {
    await expect(image).toContainText('32 × 32 × 32 voxels of 0.5 × 0.5 × 0.5, int16');
    await expect(page.locator('.iso-histogram path')).toHaveAttribute('d', /^M0 1V/);
    for (const [iso, radius] of [
      [0, 5],
      [200, 4],
      [-100, 5.5],
    ]) {
      await sliderOf(page).fill(String(iso));
      await sliderOf(page).press('Enter');
      await settled(page);
      expect((await state(page)).parameters.iso).toBe(iso);
      const { quality, components } = await report(page);
      expect(components).toBe(1);
      expect(quality.area / (4 * Math.PI * radius ** 2)).toBeCloseTo(1, 1);
    }
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('the darker side can be inside', async () => {
    await page.getByRole('radio', { name: 'Dark inside' }).check();
    await settled(page);
    expect((await state(page)).parameters).toEqual({ iso: -100, dark: 1 });
    await page.getByRole('radio', { name: 'Bright inside' }).check();
    await settled(page);
  });

  await test.step('the cutting plane shows the voxels, seen from the hidden side', async () => {
    const slice = page.locator('.marks .slice');
    await expect(slice).toBeHidden();
    await page.locator('summary', { hasText: 'Cutting plane' }).click();
    await page.getByRole('radio', { name: 'Free' }).check();
    await expect(slice).toBeVisible();
    // The middle of the ball is brighter than its rim, and opaque.
    const pixels = await slice.evaluate((/** @type {any} */ canvas) => {
      const { width, height } = canvas;
      const at = (/** @type {number} */ x) => [...canvas.getContext('2d').getImageData(x, height >> 1, 1, 1).data];
      return [at(width >> 1), at(Math.round(0.1 * width))];
    });
    expect(pixels[0][0]).toBeGreaterThan(pixels[1][0] + 50);
    expect(pixels[0][3]).toBe(255);
    await page.getByRole('button', { name: 'Flip' }).click();
    await expect(slice).toBeHidden();
    await page.getByRole('radio', { name: 'Off' }).check();
  });

  await test.step('a file that is cut off, and one of another kind, are refused', async () => {
    const { digest } = await report(page);
    await choose(page, 'cut.nii', niftiOf(() => 1).subarray(0, 9_000));
    await expect(page.locator('.refused')).toContainText('cut.nii could not be used');
    await expect(page.locator('.refused')).toContainText('cut off');
    await choose(page, 'other.nii', Buffer.from('hello, world'));
    await expect(page.locator('.refused')).toContainText('no known kind');
    await expect(page.locator('.refused')).toBeInViewport();
    expect((await report(page)).digest).toBe(digest);
    expect((await state(page)).parameters).toEqual({ iso: -100 });
  });

  await test.step('one press leads back to the formula, and undo to the image', async () => {
    await page.getByRole('button', { name: 'Back to the formula' }).click();
    await settled(page);
    await expect(image).toBeHidden();
    await page.getByRole('button', { name: 'Undo', exact: true }).click();
    await settled(page);
    await expect(image).toBeVisible();
    expect(await state(page)).toMatchObject({ surface: 'file', parameters: { iso: -100 } });
  });
  await clean();
});

/** A rod along z, which the border of the image cuts. */
const ROD = niftiOf((p) => Math.round(100 * (10 - Math.hypot(p[0] - 15.3, p[1] - 15.3))));

test('what the border cuts is open or closed', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  // Coarser particles would not see the edges of the cap.
  await page.evaluate(() => {
    const page = /** @type {any} */ (window).marchingParticles;
    return page.set({ settings: { ...page.state.settings, radius_share: 0.01 } });
  });
  await choose(page, 'rod.nii', ROD);
  await settled(page);
  expect((await report(page)).cut).not.toBe(undefined);
  expect((await report(page)).quality.euler).toBe(0);
  await page.getByRole('radio', { name: 'Closed' }).check();
  await settled(page);
  expect((await state(page)).parameters).toMatchObject({ closed: 1 });
  await page.getByRole('button', { name: 'Make a mesh' }).first().click();
  await expect(page.locator('.detail.joined')).toContainText('Closed · 1 part');
  await clean();
});

test('labels are listed with their sizes, and a link asks for the file', async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844, hash: COARSE });
  await choose(page, 'bodies.nii', BODIES);
  await expect(page.locator('.image')).toContainText('int16');
  await settled(page);
  const labels = page.getByRole('radiogroup', { name: 'Labels' });
  await expect(labels.getByRole('radio')).toHaveCount(3);
  // The larger body is shown first: the shell, with a surface outside and one inside.
  await expect(labels.getByRole('radio', { checked: true })).toHaveAccessibleName(/^5 /);
  expect((await report(page)).components).toBe(2);
  await labels.getByRole('radio', { name: /^2 / }).check();
  await settled(page);
  const { quality, components } = await report(page);
  expect(components).toBe(1);
  // The boundary of a label is known to half a voxel.
  expect(Math.abs(Math.sqrt(quality.area / (4 * Math.PI)) - 3)).toBeLessThan(0.25);
  expect((await scan(page)).violations).toEqual([]);
  await page.getByRole('radio', { name: 'Iso value' }).check();
  await settled(page);
  await expect(labels).toBeHidden();
  await expect(sliderOf(page)).toBeVisible();

  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await page.goto('about:blank');
  await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
  await expect(page.locator('.toast')).toContainText('in a file');
  const chooser = page.waitForEvent('filechooser');
  await page.locator('.toast').getByRole('button', { name: 'Open the file…' }).click();
  expect((await chooser).isMultiple()).toBe(true);
  await expect(page.locator('.toast')).toHaveCount(0);
  await settled(page);
  await clean();
});

test('the computed images of the gallery are sampled, and a link holds what is chosen of them', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  await page.getByRole('combobox', { name: 'Group of surfaces' }).selectOption('Scans');
  for (const [id, name] of [
    ['scan-bodies', 'Two bodies'],
    ['scan-benzene', 'Benzene density'],
  ]) {
    await page.locator(`.tile[data-surface="${id}"]`).click();
    await expect(page.getByRole('heading', { name })).toBeVisible();
    await settled(page);
    expect((await report(page)).search).toBe('proven');
  }
  await sliderOf(page).fill('700');
  await sliderOf(page).press('Enter');
  await settled(page);
  // Below 900, the density of a carbon, and above that between two of them, the ring falls into its atoms.
  expect((await report(page)).components).toBe(6);
  const { digest } = await report(page);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await page.goto('about:blank');
  await page.goto(`./?backend=canvas2d${new URL(link).hash}`);
  await settled(page);
  expect(await state(page)).toMatchObject({ surface: 'scan-benzene', parameters: { iso: 700 } });
  expect((await report(page)).digest).toBe(digest);
  await clean();
});
