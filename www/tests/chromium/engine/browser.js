/** What the browser tests share: opening the page with an eye on its requests and errors, and looking at its pixels. */
import { expect, test } from '@playwright/test';
import { INSIDE_TOLD, isInsideTold, pictureOf, SIDES, spotsOf } from '../../pixels.js';

/** @import { Page } from '@playwright/test' */

/** A link to a state. @param {object} state */
export const link = (state) => `#v1.j.${Buffer.from(JSON.stringify(state)).toString('base64url')}`;

/** A coarse ellipsoid: some 1,100 particles, quick to draw in software. */
export const coarse = { settings: { radius_share: 0.01 } };

/**
 * An address that asks for a back end.
 * @param {string} address @param {string} kind
 */
export const askingFor = (address, kind) => address.replace(/(?=#|$)/, `?backend=${kind}`);

/**
 * Opens the page, waits for its first picture, and expects that it is drawn as the test says.
 * @param {Page} page
 * @param {string} [address]  below the root of the host
 * @param {{asks?: string | null, drawnBy?: string}} [backend]  what the address asks for, null for nothing, and what
 *   then draws; without them both are what the project is named after
 * @returns {Promise<{errors: string[], strangers: string[]}>}  what it complained of, and whom else it asked
 */
export async function open(page, address = `./${link(coarse)}`, { asks = test.info().project.name, drawnBy } = {}) {
  const errors = /** @type {string[]} */ ([]);
  const strangers = /** @type {string[]} */ ([]);
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (url.protocol !== 'data:' && url.protocol !== 'blob:' && url.hostname !== 'localhost')
      strangers.push(request.url());
  });
  await page.goto(asks === null ? address : askingFor(address, asks));
  await page.waitForFunction(() => 'marchingParticles' in window);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  // A back end that fails may do so after the first picture.
  await expect.poll(async () => (await status(page)).backend).toBe(drawnBy ?? asks);
  return { errors, strangers };
}

/** @param {Page} page @returns {Promise<any>} */
export const status = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.status());

/** @param {Page} page @returns {Promise<any>} */
export const counts = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.counts());

/** Waits until nothing is drawn any more. @param {Page} page */
export const atRest = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.still());

/**
 * The picture as it is read back.
 * @param {Page} page @param {number} width @param {number} height @returns {Promise<import('../../pixels.js').Pixels>}
 */
export const pixels = (page, width, height) =>
  page.evaluate(([w, h]) => /** @type {any} */ (window).marchingParticles.pixels(w, h), [width, height]);

/** What is in the picture. @param {Page} page @param {number} [width] @param {number} [height] */
export const picture = async (page, width = 160, height = 120) => pictureOf(await pixels(page, width, height));

/** The picture shows a surface in many colours, not a blank or a flat one. @param {Page} page */
export async function expectSurface(page) {
  const seen = await picture(page);
  expect(seen.drawn).toBeGreaterThan(0.12);
  expect(seen.drawn).toBeLessThan(0.85);
  expect(seen.hues).toBeGreaterThanOrEqual(6);
  expect(seen.middle.slice(0, 3)).not.toEqual(seen.corner);
}

/**
 * The canvas itself, as the screen shows it, holds as many colours. (Not for WebGPU in software: its canvas cannot be
 * photographed.)
 * @param {Page} page
 */
export async function expectCanvasShown(page) {
  // Panels and the poster must not lend the picture their colours.
  await page.evaluate(() => {
    const panels = /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll('#shell, #poster, #toasts'));
    for (const panel of panels) panel.style.visibility = 'hidden';
  });
  const shot = await page.locator('#canvas-host canvas').screenshot();
  const colours = await page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(
      new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: 'image/png' }),
    );
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext('2d'));
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4)
      seen.add(((data[i] >> 4) << 8) | ((data[i + 1] >> 4) << 4) | (data[i + 2] >> 4));
    return seen.size;
  }, shot.toString('base64'));
  expect(colours).toBeGreaterThan(40);
}

/** The separate spots in the picture. @param {Page} page */
export const spots = async (page) => spotsOf(await pixels(page, 600, 450));

/**
 * Expects that an inside is told from an outside, on a light and on a dark ground.
 * @param {Page} page @param {'discs' | 'mesh'} draw
 */
export async function expectInside(page, draw) {
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    const pictures = [];
    for (const side of SIDES) {
      await page.evaluate(
        async ({ side, draw, theme }) => {
          const mp = /** @type {any} */ (window).marchingParticles;
          // The colours of the levels cover all hues, so their mean says nothing of the shade of one.
          mp.engine.setView({ draw, theme, size: 1.1, colour: 'plain', edges: false, marks: false });
          await mp.set(side);
          while (draw === 'mesh' && !mp.status().mesh) await new Promise((go) => setTimeout(go, 50));
        },
        { side, draw, theme },
      );
      pictures.push(await pixels(page, 160, 120));
    }
    // The inside of a mesh is lit: one looks into it where the box cuts it.
    const lightest = draw === 'mesh' ? 0.97 : undefined;
    expect(isInsideTold(pictures, lightest), `${draw} on ${theme}`).toEqual(INSIDE_TOLD);
  }
}
