/** The packed package in a browser: served as it is, and built by Vite. */
import { readFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { expect, test } from '@playwright/test';
import { build } from 'vite';
import { GYROID, install, programOf } from '../package/packed.js';

const { runs } = JSON.parse(readFileSync(new URL('../../../tests/golden/digests.json', import.meta.url), 'utf8'));
const golden = runs.find((/** @type {{name: string}} */ { name }) => name === GYROID.golden);

/** @type {Record<string, string>} */
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/** @type {ReturnType<typeof install>} */
let there;
test.beforeAll(() => {
  there = install();
});
test.afterAll(() => there.remove());

/**
 * Opens a folder of the project as a site, and returns the digest that its page tells.
 * @param {import('@playwright/test').Page} page @param {string} folder
 */
async function digestIn(page, folder) {
  await page.route('**/package-test/**', (route) => {
    const name = new URL(route.request().url()).pathname.replace('/package-test/', '') || 'index.html';
    const body = readFileSync(join(there.project, folder, name));
    return route.fulfill({ contentType: TYPES[extname(name)] ?? 'application/octet-stream', body });
  });
  await page.goto('/package-test/');
  await expect(page).toHaveTitle(/^[0-9a-f]{16}$/);
  return page.title();
}

test('a script of a page samples without a bundler', async ({ page }) => {
  const modules = { imports: { 'marching-particles': './node_modules/marching-particles/index.js' } };
  there.write(
    'index.html',
    `<script type="importmap">${JSON.stringify(modules)}</script>
<script type="module">${programOf('document.title = ')}</script>`,
  );
  expect(await digestIn(page, '.')).toBe(golden.digest);
});

test('a page that Vite builds samples the same', async ({ page }) => {
  there.write('index.html', '<script type="module" src="./program.js"></script>');
  there.write('program.js', programOf('document.title = '));
  const how = {
    root: there.project,
    base: './',
    configFile: /** @type {const} */ (false),
    logLevel: /** @type {const} */ ('warn'),
  };
  await build({ ...how, build: { outDir: 'built', target: 'es2022' }, worker: { format: 'es' } });
  expect(await digestIn(page, 'built')).toBe(golden.digest);
});
