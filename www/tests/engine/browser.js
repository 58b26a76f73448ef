/** What the browser tests share: opening the page with an eye on its requests and errors, and looking at its pixels. */
import { expect } from '@playwright/test';

/** @import { Page } from '@playwright/test' */

/** A link to a state. @param {object} state */
export const link = (state) => `#v1.j.${Buffer.from(JSON.stringify(state)).toString('base64url')}`;

/** A coarse ellipsoid: some 1,100 particles, quick to draw in software. */
export const coarse = { settings: { radius_share: 0.01 } };

/**
 * Opens the page and waits for its first picture.
 * @param {Page} page
 * @param {string} [address]  below the root of the host
 * @returns {Promise<{errors: string[], strangers: string[]}>}  what it complained of, and whom else it asked
 */
export async function open(page, address = `./${link(coarse)}`) {
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
  await page.goto(address);
  await page.waitForFunction(() => 'marchingParticles' in window);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  return { errors, strangers };
}

/** @param {Page} page @returns {Promise<any>} */
export const status = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.status());

/** @param {Page} page @returns {Promise<any>} */
export const counts = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.counts());

/** Waits until nothing is drawn any more. @param {Page} page */
export const atRest = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.still());

/**
 * What is in the picture: the share of pixels that differ from its corner and of those that have a colour, and how many
 * of 12 hues there are.
 * @param {Page} page
 * @param {number} [width] @param {number} [height]
 */
export function picture(page, width = 160, height = 120) {
  return page.evaluate(
    async ([w, h]) => {
      const { pixels, width: pw, height: ph } = await /** @type {any} */ (window).marchingParticles.pixels(w, h);
      const corner = [pixels[0], pixels[1], pixels[2]];
      const hues = new Array(12).fill(0);
      let drawn = 0;
      let coloured = 0;
      for (let i = 0; i < pixels.length; i += 4) {
        const [r, g, b] = [pixels[i], pixels[i + 1], pixels[i + 2]];
        if (Math.abs(r - corner[0]) + Math.abs(g - corner[1]) + Math.abs(b - corner[2]) < 24) continue;
        drawn += 1;
        const most = Math.max(r, g, b);
        const chroma = most - Math.min(r, g, b);
        if (chroma < 20) continue;
        coloured += 1;
        const hue = most === r ? (g - b) / chroma + 6 : most === g ? (b - r) / chroma + 2 : (r - g) / chroma + 4;
        hues[Math.floor(hue * 2) % 12] += 1;
      }
      const middle = 4 * (Math.floor(ph / 2) * pw + Math.floor(pw / 2));
      return {
        width: pw,
        height: ph,
        drawn: drawn / (pw * ph),
        coloured: coloured / (pw * ph),
        hues: hues.filter((n) => n > 4).length,
        corner,
        middle: [...pixels.subarray(middle, middle + 4)],
      };
    },
    [width, height],
  );
}

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

/**
 * The separate spots in the picture, their areas in pixels and how far their middles lie from the picture's, largest
 * first; and how many pixels are nearly black and nearly white.
 * @param {Page} page
 * @param {number} [width] @param {number} [height]
 */
export function spots(page, width = 600, height = 450) {
  return page.evaluate(
    async ([w, h]) => {
      const { pixels, width: pw, height: ph } = await /** @type {any} */ (window).marchingParticles.pixels(w, h);
      const [r0, g0, b0] = pixels;
      const drawn = new Uint8Array(pw * ph);
      let [black, white] = [0, 0];
      for (let i = 0; i < drawn.length; i += 1) {
        const [r, g, b] = pixels.subarray(4 * i, 4 * i + 3);
        drawn[i] = Number(Math.abs(r - r0) + Math.abs(g - g0) + Math.abs(b - b0) > 60);
        black += Number(Math.max(r, g, b) < 40);
        white += Number(Math.min(r, g, b) > 215);
      }
      const found = [];
      for (let start = 0; start < drawn.length; start += 1) {
        if (!drawn[start]) continue;
        const open = [start];
        drawn[start] = 0;
        let [area, sumX, sumY] = [0, 0, 0];
        for (let at = open.pop(); at !== undefined; at = open.pop()) {
          area += 1;
          const x = at % pw;
          sumX += x;
          sumY += Math.floor(at / pw);
          for (const [next, inside] of /** @type {[number, boolean][]} */ ([
            [at - 1, x > 0],
            [at + 1, x < pw - 1],
            [at - pw, at >= pw],
            [at + pw, at < pw * (ph - 1)],
          ])) {
            if (!inside || !drawn[next]) continue;
            drawn[next] = 0;
            open.push(next);
          }
        }
        found.push({ area, off: Math.hypot(sumX / area - pw / 2, sumY / area - ph / 2) });
      }
      return { found: found.sort((p, q) => q.area - p.area), black, white };
    },
    [width, height],
  );
}

/**
 * Expects that a plane is darker and greyer from behind than from the front, and stands out from the ground on both
 * sides.
 * @param {Page} page @param {'discs' | 'mesh'} draw
 */
export async function expectInside(page, draw) {
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    const [front, behind, ground] = await page.evaluate(
      async ({ draw, theme }) => {
        const mp = /** @type {any} */ (window).marchingParticles;
        // The colours of the levels cover all hues, so their mean says nothing of the shade of one.
        mp.engine.setView({ draw, theme, size: 1.1, colour: 'plain', edges: false, marks: false });
        const bytes = [];
        for (const formula of ['x+y+z=0', '0=x+y+z']) {
          await mp.set({ formula, bounds: { min: [-1, -1, -1], max: [1, 1, 1] }, settings: { radius_share: 0.02 } });
          for (let i = 0; i < 100 && draw === 'mesh' && !mp.status().mesh; i += 1)
            await new Promise((go) => setTimeout(go, 50));
          const { pixels } = await mp.pixels(160, 120);
          const at = (/** @type {number} */ x, /** @type {number} */ y) => 4 * (160 * y + x);
          // The mean of a patch in the middle, without what is ground between discs, and the ground of a corner.
          const ground = [...pixels.subarray(0, 3)];
          const sum = [0, 0, 0, 0];
          for (let y = 52; y < 68; y += 1) {
            for (let x = 72; x < 88; x += 1) {
              const p = [...pixels.subarray(at(x, y), at(x, y) + 3)];
              if (p.every((v, k) => Math.abs(v - ground[k]) < 8)) continue;
              for (let k = 0; k < 3; k += 1) sum[k] += p[k];
              sum[3] += 1;
            }
          }
          bytes.push(sum.slice(0, 3).map((v) => v / sum[3]));
          if (bytes.length === 2) bytes.push(ground);
        }
        return bytes;
      },
      { draw, theme },
    );
    const light = (/** @type {number[]} */ [r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
    const spread = (/** @type {number[]} */ rgb) => Math.max(...rgb) - Math.min(...rgb);
    const told = `${draw} on ${theme}: ${JSON.stringify([front, behind, ground])}`;
    expect(light(behind), told).toBeLessThan(0.75 * light(front));
    expect(spread(behind), told).toBeLessThan(spread(front));
    expect(Math.abs(light(behind) - light(ground)), told).toBeGreaterThan(20);
  }
}
