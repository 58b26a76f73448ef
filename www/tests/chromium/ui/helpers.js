/** What the interface's browser tests share. */
import { expect } from '@playwright/test';
import { axe } from '../../axe.js';
import { link } from '../engine/browser.js';

/** @import { Page } from '@playwright/test' */

/** The panels are tested without a graphics device: software rendering of large windows is slow. */
const ADDRESS = './?backend=canvas2d';

/**
 * A link to the surface of the first page with few particles, for panels that are the same with
 * many.
 */
export const COARSE = link({ settings: { radius_share: 0.03 } });

/**
 * Opens the page and waits for the first run. Violations of the content security policy and errors fail the test.
 * @param {Page} page
 * @param {{ width?: number, height?: number, hash?: string, folded?: boolean, invites?: boolean }} [options]  `folded`:
 *   the panels are as on a first visit; `invites`: so is the first slider, which moves by itself
 */
export async function open(page, { width = 1280, height = 800, hash = '', folded = false, invites = false } = {}) {
  /** @type {string[]} */
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') faults.push(message.text());
  });
  await page.addInitScript(() => {
    const seen = /** @type {string[]} */ ([]);
    /** @type {any} */ (window).violations = seen;
    document.addEventListener('securitypolicyviolation', (event) =>
      seen.push(`${event.violatedDirective} ${event.blockedURI} ${event.sample}`),
    );
  });
  if (!invites)
    await page.addInitScript(() => {
      if (location.protocol !== 'about:') localStorage.setItem('marching-particles.invited', 'on');
    });
  // Most tests begin with all panels open.
  if (!folded)
    await page.addInitScript(() => {
      if (location.protocol === 'about:') return;
      for (const name of ['sampling', 'report']) localStorage.setItem(`marching-particles.fold-${name}`, 'off');
    });
  await page.setViewportSize({ width, height });
  await page.goto(`${ADDRESS}${hash}`);
  await settled(page);
  return {
    faults,
    clean: async () => {
      expect(faults).toEqual([]);
      expect(await page.evaluate(() => /** @type {any} */ (window).violations)).toEqual([]);
    },
  };
}

/**
 * Brings a page back to the state in which it opens, or to that of a link, for the next step of a test.
 * @param {Page} page
 * @param {{ width?: number, height?: number, hash?: string }} [options]
 */
export async function afresh(page, { width = 1280, height = 800, hash = '' } = {}) {
  await page.setViewportSize({ width, height });
  await page.mouse.move(0, 0);
  // A layer that is open, or its explanation.
  for (let k = 0; k < 2; k += 1) await page.keyboard.press('Escape');
  await page.evaluate(async (link) => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.dismissNotice();
    engine.dismissHover();
    const { run } = engine.progress.value;
    await engine.openLink(link);
    while (engine.progress.value.run === run) await new Promise((go) => setTimeout(go, 10));
  }, hash);
  await settled(page);
}

/**
 * Waits until nothing runs and the figures are there, and expects that the picture is drawn as the address asks.
 * @param {Page} page
 * @param {string | null} [drawnBy]  back end, where the address asks for none
 */
export async function settled(page, drawnBy = new URL(page.url()).searchParams.get('backend')) {
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  await page.waitForFunction(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    return (
      engine.trial.value !== 'typing' &&
      engine.status.value !== 'sampling' &&
      engine.loading.value === null &&
      engine.reveal.value === null &&
      engine.progress.value.phase === 'done' &&
      (engine.report.value !== null || engine.result.value === 'none')
    );
  });
  await expectDrawn(page, drawnBy);
}

/** Expects that a back end draws the picture. @param {Page} page @param {string | null} kind */
export async function expectDrawn(page, kind) {
  const drawnBy = () => page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().backend);
  await expect.poll(drawnBy).toBe(kind);
}

/**
 * Waits until nothing fades or glides any more and the camera has told where it is.
 * @param {Page} page
 */
export async function atRest(page) {
  await page.waitForFunction(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    return engine.trial.value !== 'typing' && engine.status.value !== 'sampling' && engine.reveal.value === null;
  });
  await page.waitForFunction(() => document.getAnimations().every(({ playState }) => playState !== 'running'));
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.still());
}

/** What axe has to say; nothing is scanned half-way through a fade. @param {Page} page */
export async function scan(page) {
  await atRest(page);
  return axe(page);
}

/** Opens the part of the report that is folded at first. @param {Page} page */
export const openFigures = (page) => page.locator('.all-figures:not([open]) > summary').click();

/** @param {Page} page @returns {Promise<any>} */
export const report = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.report());

/** @param {Page} page @returns {Promise<any>} */
export const state = (page) => page.evaluate(() => /** @type {any} */ (window).marchingParticles.state);

/**
 * Types a formula into the editor in place of the one there.
 * @param {Page} page
 * @param {string} text
 */
export async function typeFormula(page, text) {
  const editor = page.getByRole('textbox', { name: 'Formula' });
  await editor.click();
  await expect(page.locator('.code-host')).toBeVisible();
  await page.keyboard.press('ControlOrMeta+a');
  await page.keyboard.press('Delete');
  if (text) await page.keyboard.insertText(text);
  await expect.poll(async () => (await state(page)).formula).toBe(text);
}
