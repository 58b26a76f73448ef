/** An engine stands alone: two of them on one page, and one that goes. */
import { expect, test } from '@playwright/test';
import { coarse, link, open } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {string} expression  of p, the console @returns {Promise<any>} */
const on = (page, expression) =>
  page.evaluate(
    (body) => new Function('p', `return (${body})`)(/** @type {any} */ (window).marchingParticles),
    expression,
  );

test('a second engine in its own element has its own state, run and picture, and leaves nothing when it goes', {
  tag: '@all',
}, async ({ page }) => {
  const { errors } = await open(page);
  const address = page.url();
  const before = await on(page, 'p.state');
  await page.evaluate(() => {
    const host = document.body.appendChild(document.createElement('div'));
    Object.assign(host.style, { position: 'fixed', inset: '0 auto auto 0', width: '200px', height: '200px' });
    const p = /** @type {any} */ (window).marchingParticles;
    const state = { surface: 'torus', settings: { radius_share: 0.02 } };
    Object.assign(window, { second: p.create({ host, state, backend: 'webgl2' }), host });
  });
  const second = (/** @type {string} */ expression) =>
    page.evaluate((body) => {
      const { second: engine, host } = /** @type {any} */ (window);
      return new Function('engine', 'host', `return (${body})`)(engine, host);
    }, expression);
  await expect.poll(() => second('engine.report.value?.count ?? 0')).toBeGreaterThan(100);
  expect(await second('engine.state.value.surface')).toBe('torus');
  expect(await second('engine.backend.value')).toBe('webgl2');
  await second('engine.debug.still()');
  const picture = () => second(`engine.picture().then(({ data }) => new Set(new Uint32Array(data.buffer)).size)`);
  expect(await picture()).toBeGreaterThan(50);
  expect(page.workers()).toHaveLength(2);

  // Neither the first one nor the address has heard of it.
  expect(await on(page, 'p.state')).toEqual(before);
  expect(page.url()).toBe(address);
  expect(await on(page, 'p.engine.link()')).toBe(link(coarse));

  await second('engine.destroy()');
  await expect.poll(() => page.workers().length).toBe(1);
  expect(await second('host.childNodes.length')).toBe(0);
  expect((await on(page, 'p.run()')).count).toBeGreaterThan(500);
  expect(errors).toEqual([]);
});
