/** What the browser tests of the lesson share. */
import { expect } from '@playwright/test';
import { packCarried } from '../../../src/ui/surface-link.js';

/** @import { Locator, Page } from '@playwright/test' */

/** A torus, as the first page hands it over. */
export const TORUS = packCarried({
  surface: {
    formula: '(sqrt(x^2 + y^2) - R)^2 + z^2 = 0.09',
    parameters: [{ name: 'R', label: 'R', value: 0.7, min: 0, max: 1, step: 0.01 }],
    bounds: { min: [-1.2, -1.2, -0.5], max: [1.2, 1.2, 0.5] },
  },
  from: '',
});

/**
 * Opens the lesson. Errors and violations of the content security policy fail the test.
 * @param {Page} page
 * @param {{ hash?: string, width?: number, height?: number, place?: string }} [how]
 */
export async function openLesson(page, { hash = '', width = 1280, height = 800, place = './' } = {}) {
  /** @type {string[]} */
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') faults.push(message.text());
  });
  await page.addInitScript(() => {
    document.addEventListener('securitypolicyviolation', (event) => console.error(event.violatedDirective));
  });
  await page.setViewportSize({ width, height });
  await page.goto(`${place}learn/${hash}`);
  return { clean: () => expect(faults).toEqual([]) };
}

/** Waits until a figure has come to an end, whatever it is. @param {Page} page @param {string} name */
export async function settled(page, name) {
  const stage = page.locator(`[data-figure="${name}"]`);
  await stage.scrollIntoViewIfNeeded();
  await expect(stage).toHaveAttribute('data-state', /live|still/);
  return stage;
}

/** @param {Page} page @param {string} name */
export async function live(page, name) {
  const stage = await settled(page, name);
  await expect(stage).toHaveAttribute('data-state', 'live');
  return stage;
}

/** The width by which the page can be scrolled sideways. @param {Page} page */
export const overflow = (page) =>
  page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

/** A number that stands for what a picture shows. @param {Locator} picture */
export const fingerprint = (picture) =>
  picture.locator('canvas').evaluate((element) => {
    const canvas = /** @type {HTMLCanvasElement} */ (element);
    const data = canvas.getContext('2d')?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
    let sum = 0;
    for (let i = 0; i < data.length; i += 37) sum = (sum * 31 + data[i]) % 1_000_003;
    return sum;
  });
