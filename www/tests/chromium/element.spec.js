/** The element of the packed package in a browser: what its attributes say, and what they say no more. */
import { readFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { expect, test } from '@playwright/test';
import { install } from '../package/packed.js';

/** @import { Page } from '@playwright/test' */

/** @type {Record<string, string>} */
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/** @type {ReturnType<typeof install>} */
let there;
test.beforeAll(() => {
  there = install();
});
test.afterAll(() => there.remove());

/**
 * Opens a page with an element, whose events are kept.
 * @param {Page} page @param {string} attributes @param {number} [coreMs]  after which its core comes
 */
async function open(page, attributes, coreMs = 0) {
  const modules = { imports: { 'marching-particles/element': './element.js' } };
  const html = `<script type="importmap">${JSON.stringify(modules)}</script>
<marching-particles ${attributes} backend="canvas2d" style="width: 320px"></marching-particles>
<script>
globalThis.told = [];
globalThis.shown = document.querySelector('marching-particles');
for (const name of ['report', 'error'])
  shown.addEventListener(name, ({ detail }) => told.push(name === 'report' ? name : detail.message));
</script>
<script type="module">import 'marching-particles/element';</script>`;
  await page.route('**/element-test/**', async (route) => {
    const name = new URL(route.request().url()).pathname.replace('/element-test/', '');
    if (name === 'core_bg.wasm') await new Promise((resolve) => setTimeout(resolve, coreMs));
    const body = name ? readFileSync(join(there.project, 'node_modules/marching-particles', name)) : html;
    return route.fulfill({ contentType: TYPES[extname(name)] ?? 'text/html', body });
  });
  await page.goto('/element-test/');
}
/** @param {Page} page @param {string} expression  of the element and what it told @returns {Promise<any>} */
const on = (page, expression) =>
  page.evaluate((body) => {
    const { shown, told } = /** @type {any} */ (globalThis);
    return new Function('shown', 'told', `return (${body})`)(shown, told);
  }, expression);
/** @param {Page} page */
async function sampled(page) {
  await expect.poll(() => on(page, 'shown.report?.components')).toBe(1);
  await expect.poll(() => on(page, 'shown.view.backend')).toBe('canvas2d');
}

test('an attribute that was wrong when the element came into sight opens the picture once it is right', {
  tag: '@all',
}, async ({ page }) => {
  await open(page, 'surface="torus" count="many"');
  await expect.poll(() => on(page, 'told')).toEqual(['count="many": a number.']);
  expect(await on(page, 'shown.view')).toBeNull();
  await on(page, 'shown.count = 400');
  await sampled(page);
  expect(Math.abs((await on(page, 'shown.report.count')) - 400)).toBeLessThan(40);
});

test('an element is busy until its particles are there, and takes parameters before that', { tag: '@all' }, async ({
  page,
}) => {
  await open(page, 'formula="x^2 + y^2 + z^2 = a" params="a=2" count="300"', 1500);
  await expect.poll(() => on(page, 'shown.view !== null')).toBe(true);
  await on(page, 'shown.params = "a=0.5"');
  expect(await on(page, 'shown.report')).toBeNull();
  expect(await on(page, 'shown.ariaBusy')).toBe('true');
  await sampled(page);
  await expect.poll(() => on(page, 'shown.ariaBusy')).toBe('false');
  await expect.poll(() => on(page, 'shown.view.state.params')).toEqual({ a: 0.5 });
});

test('an attribute that goes takes back what it said', { tag: '@all' }, async ({ page }) => {
  await open(page, 'surface="torus" params="R=0.9, r=0.3" count="300" draw="mesh" colour="normal" theme="dark"');
  await sampled(page);
  expect(await on(page, 'shown.ariaLabel')).toBe('torus');
  await on(page, 'shown.params = "R=0.8"');
  await expect.poll(() => on(page, 'shown.view.state.params')).toEqual({ R: 0.8 });
  await on(page, '["surface", "params", "draw", "colour", "theme"].forEach((name) => shown.removeAttribute(name))');
  await expect.poll(() => on(page, 'shown.view.state.surface')).toBe('ellipsoid');
  const { params, view } = await on(page, 'shown.view.state');
  expect(params).toEqual({});
  expect(view).toMatchObject({ draw: 'discs', colour: 'level', theme: 'auto' });
  expect(await on(page, 'shown.hasAttribute("aria-label")')).toBe(false);
  await sampled(page);
  expect(await on(page, 'told.every((what) => what === "report")')).toBe(true);
});

test('a picture without controls is no stop of the keys, and with them it is', { tag: '@all' }, async ({ page }) => {
  await open(page, 'surface="torus" count="300"');
  await sampled(page);
  const active = () => on(page, 'document.activeElement === shown');
  await page.keyboard.press('Tab');
  expect(await active()).toBe(false);
  await on(page, 'shown.focus()');
  expect(await active()).toBe(false);
  await on(page, 'shown.controls = true');
  await page.keyboard.press('Tab');
  expect(await active()).toBe(true);
});
