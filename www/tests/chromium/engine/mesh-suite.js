/** The mesh in the picture: that it is drawn, how its edges, marks and colours look, and when it comes and goes. */
import { expect, test } from '@playwright/test';
import { atRest, expectInside, open, picture, pixels, status } from './browser.js';

/**
 * @import { Page } from '@playwright/test'
 * @import { ViewState } from '../../../src/engine/types.js'
 */

/** @param {Page} page @param {Partial<ViewState>} view */
async function look(page, view) {
  await page.evaluate((v) => /** @type {any} */ (window).marchingParticles.engine.setView(v), view);
  await expect.poll(async () => (await status(page)).mesh !== null).toBe(view.draw !== 'discs');
  await atRest(page);
}

/** Share of the pixels that differ visibly. @param {Uint8Array} a @param {Uint8Array} b */
function differing(a, b) {
  let n = 0;
  for (let i = 0; i < a.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > 4)) n += 1;
  }
  return (4 * n) / a.length;
}

export const suite = () =>
  test('a mesh closes the gaps between discs, and comes and goes with its particles', { tag: '@all' }, async ({
    page,
  }) => {
    const { errors } = await open(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ size: 0.3, body: false }));
    await atRest(page);
    const discs = (await picture(page)).drawn;
    const plain = /** @type {const} */ ({ draw: 'mesh', colour: 'level', faces: 'smooth', edges: false, marks: false });
    const seen = async () => (await pixels(page, 160, 120)).pixels;
    await look(page, plain);
    // Through the gaps the inside of the far side is seen, which is drawn, too.
    expect((await picture(page)).drawn).toBeGreaterThan(1.25 * discs);

    await test.step('every option of it can be seen', async () => {
      const smooth = await seen();
      for (const option of /** @type {const} */ ([
        { faces: 'flat' },
        { edges: true },
        { marks: true },
        { colour: 'normal' },
      ])) {
        await look(page, { ...plain, ...option });
        expect(differing(await seen(), smooth), JSON.stringify(option)).toBeGreaterThan(0.005);
      }
      await look(page, plain);
      expect(differing(await seen(), smooth)).toBe(0);
    });

    await test.step('it is on the canvas in the colours that are read back', async () => {
      await look(page, { ...plain, colour: 'plain' });
      const box = await page.locator('#canvas-host canvas').boundingBox();
      if (!box) throw new Error('the canvas has no box');
      // A corner of the canvas that no panel covers shows the background alone.
      const shot = await page.screenshot({ clip: { x: box.x, y: box.y, width: 4, height: 4 } });
      // Decoded in a page without a content security policy.
      const blank = await page.context().newPage();
      const shown = await blank.evaluate(async (data) => {
        const image = new Image();
        image.src = `data:image/png;base64,${data}`;
        await image.decode();
        const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(4, 4).getContext('2d'));
        context.drawImage(image, 0, 0);
        return Array.from(context.getImageData(2, 2, 1, 1).data.subarray(0, 3));
      }, shot.toString('base64'));
      await blank.close();
      expect(shown).toEqual([...(await seen()).subarray(0, 3)]);
    });

    await test.step('it goes with its particles, comes back with the next ones, and after the device was lost', async () => {
      const before = (await status(page)).mesh;
      expect(before.components[0].euler).toBe(2);
      await page.evaluate(() =>
        /** @type {any} */ (window).marchingParticles.set({ surface: 'torus', settings: { radius_share: 0.015 } }),
      );
      await expect.poll(async () => (await status(page)).mesh?.components[0].euler).toBe(0);
      expect((await status(page)).mesh.triangles).not.toBe(before.triangles);
      await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.loseDevice());
      await expect.poll(async () => (await status(page)).notice?.text).toContain('is back');
      await atRest(page);
      expect((await picture(page)).drawn).toBeGreaterThan(0.1);
    });

    await test.step('it is darker where it stands in its own light', async () => {
      // The flanks of a straight valley, seen from above, are lit alike but for what they take from each other.
      await page.evaluate(() =>
        /** @type {any} */ (window).marchingParticles.set({
          formula: 'z = 2 abs(x)',
          bounds: { min: [-1, -1, -1], max: [1, 1, 3] },
          settings: { radius_share: 0.02 },
        }),
      );
      const camera = {
        target: /** @type {[number, number, number]} */ ([0, 0, 0]),
        distance: 9,
        yaw: 0,
        pitch: 1.5,
        fit: false,
      };
      await look(page, { ...plain, colour: 'plain', projection: 'orthographic', creases: false, camera });
      const { pixels: bytes } = await pixels(page, 160, 120);
      const light = (/** @type {number} */ row) => bytes[4 * (160 * row + 80)];
      // The bottom lies across the middle.
      for (const side of [-1, 1]) expect(light(60 + 22 * side)).toBeGreaterThan(1.1 * light(60 + 3 * side));
    });

    await test.step('spheres stand out from the surface on which discs lie', async () => {
      await page.evaluate(
        (v) => /** @type {any} */ (window).marchingParticles.set({ surface: 'ellipsoid', settings: v }),
        { radius_share: 0.02 },
      );
      const seenAs = async (/** @type {'discs' | 'spheres'} */ draw) => {
        await page.evaluate((v) => /** @type {any} */ (window).marchingParticles.engine.setView(v), { draw, size: 1 });
        await atRest(page);
        return { ...(await picture(page)), pixels: await seen() };
      };
      const [discs, spheres] = [await seenAs('discs'), await seenAs('spheres')];
      expect(spheres.drawn).toBeGreaterThan(1.02 * discs.drawn);
      expect(differing(spheres.pixels, discs.pixels)).toBeGreaterThan(0.3 * spheres.drawn);
    });

    await test.step('what is seen from behind is darker and greyer, on a light and on a dark ground', async () => {
      await expectInside(page, 'discs');
      await expectInside(page, 'mesh');
    });
    expect(errors).toEqual([]);
  });
