/** The packed package in a browser: served as it is, in one file, and built by three bundlers. */
import { readdirSync, readFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { expect, test } from '@playwright/test';
import esbuild from 'esbuild';
import { build } from 'vite';
import webpack from 'webpack';
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

/** Opens a folder of the project as a site. @param {import('@playwright/test').Page} page @param {string} folder */
async function serve(page, folder) {
  await page.route('**/package-test/**', (route) => {
    const name = new URL(route.request().url()).pathname.replace('/package-test/', '') || 'index.html';
    const body = readFileSync(join(there.project, folder, name));
    return route.fulfill({ contentType: TYPES[extname(name)] ?? 'application/octet-stream', body });
  });
  await page.goto('/package-test/');
}

/**
 * Opens a folder of the project as a site, and returns the digest that its page tells.
 * @param {import('@playwright/test').Page} page @param {string} folder
 */
async function digestIn(page, folder) {
  await serve(page, folder);
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

test('a page that allows no worker samples by the one file, under a strict policy', { tag: '@all' }, async ({
  page,
}) => {
  const modules = { imports: { 'marching-particles': './node_modules/marching-particles/inline.js' } };
  const policy = "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'";
  there.write(
    'index.html',
    `<meta http-equiv="content-security-policy" content="${policy}">
<script type="importmap">${JSON.stringify(modules)}</script>
<script type="module">${programOf('document.title = ')}</script>`,
  );
  expect(await digestIn(page, '.')).toBe(golden.digest);
});

test('a function of a page leaves it time to draw', { tag: '@all' }, async ({ page }) => {
  const modules = { imports: { 'marching-particles': './node_modules/marching-particles/index.js' } };
  there.write(
    'index.html',
    `<script type="importmap">${JSON.stringify(modules)}</script>
<script type="module">import { sample } from 'marching-particles';
let frames = 0;
const count = () => void requestAnimationFrame(count, frames += 1);
count();
const ball = await sample((x, y, z) => Math.hypot(x, y, z) - 1, { count: 50_000 });
if (frames > 5 && Math.abs(ball.count - 50_000) < 1500) document.title = ball.digest;
</script>`,
  );
  expect(await digestIn(page, '.')).toMatch(/^[0-9a-f]{16}$/);
});

test('an element of a page samples and draws once it is in sight, by its attributes', async ({ page }) => {
  const modules = { imports: { 'marching-particles/element': './node_modules/marching-particles/element.js' } };
  there.write(
    'index.html',
    `<script type="importmap">${JSON.stringify(modules)}</script>
<marching-particles id="a" backend="webgl2" formula="x^2 + y^2 + z^2 = a" params="a=2" count="500" style="width: 320px"></marching-particles>
<div style="height: 4000px"></div>
<marching-particles id="b" backend="webgl2" surface="torus" count="600" draw="mesh" controls style="width: 320px"></marching-particles>
<script>
globalThis.told = { a: [], b: [] };
for (const id of ['a', 'b']) for (const name of ['progress', 'report', 'error'])
  document.getElementById(id).addEventListener(name, ({ detail }) => told[id].push([name, detail]));
</script>
<script type="module">import 'marching-particles/element';</script>`,
  );
  await serve(page, '.');
  /** @param {string} id @param {string} name */
  const last = (id, name) =>
    page.evaluate(
      ([id, name]) =>
        /** @type {any} */ (globalThis).told[id].findLast((/** @type {string[]} */ [n]) => n === name)?.[1],
      [id, name],
    );
  await expect.poll(async () => (await last('a', 'report'))?.components).toBe(1);
  expect(Math.abs((await last('a', 'report')).count - 500)).toBeLessThan(30);
  await expect(page.locator('#a')).toHaveAttribute('aria-label', /x\^2/);
  expect(await page.locator('#b canvas').count()).toBe(0);
  await page.evaluate(() => document.getElementById('a')?.setAttribute('count', '900'));
  await expect.poll(async () => Math.round((await last('a', 'report')).count / 100)).toBe(9);
  await page.evaluate(() => document.getElementById('a')?.setAttribute('formula', 'x^2 + sqtr(y) - 1'));
  await expect
    .poll(() =>
      page.evaluate(
        () =>
          /** @type {any} */ (globalThis).told.a.findLast((/** @type {string[]} */ [n]) => n === 'error')?.[1]?.name,
      ),
    )
    .toBe('FormulaError');
  await page.locator('#b').scrollIntoViewIfNeeded();
  await expect.poll(async () => (await last('b', 'report'))?.components).toBe(1);
  const kinds = () =>
    page.evaluate(() => [...document.querySelectorAll('marching-particles')].map(({ view }) => view?.backend));
  await expect.poll(kinds).toEqual(['webgl2', 'webgl2']);
  const head = await page.evaluate(async () =>
    String.fromCharCode(...(await document.querySelectorAll('marching-particles')[1].toFile('glb')).subarray(0, 4)),
  );
  expect(head).toBe('glTF');
  const camera = () => page.evaluate(() => /** @type {any} */ (document.getElementById('b')).view.state.view.camera);
  const before = await camera();
  // Without controls there is nothing to press.
  expect(await page.evaluate(() => document.getElementById('a')?.role)).toBe('img');
  await page.evaluate(() => document.getElementById('a')?.focus());
  expect(await page.evaluate(() => document.activeElement?.id)).toBe('');
  await page.keyboard.press('Tab');
  expect(await page.evaluate(() => [document.activeElement?.id, document.activeElement?.role])).toEqual(['b', 'group']);
  await page.keyboard.press('ArrowRight');
  await expect.poll(async () => (await camera()).yaw).not.toBe(before.yaw);
  await page.keyboard.press('+');
  await expect.poll(async () => (await camera()).distance).toBeLessThan(before.distance);
  await page.keyboard.press('f');
  await expect.poll(async () => (await camera()).fit).toBe(true);
  await page.evaluate(() => document.getElementById('b')?.remove());
});

test('a second version of the element leaves the pictures to the first, and says so', { tag: '@all' }, async ({
  page,
}) => {
  const modules = './node_modules/marching-particles/element.js';
  there.write(
    'index.html',
    `<marching-particles backend="canvas2d" formula="x^2 + y^2 + z^2 = 1" count="300" style="width: 320px"></marching-particles>
<script type="module">
const first = await import('${modules}');
const second = await import('${modules}?another');
document.querySelector('marching-particles').addEventListener('report', ({ target }) => {
  document.title = [target instanceof first.MarchingParticles, target instanceof second.MarchingParticles].join(' ');
});
</script>`,
  );
  /** @type {string[]} */
  const warned = [];
  page.on('console', (message) => message.type() === 'warning' && warned.push(message.text()));
  await serve(page, '.');
  await expect(page).toHaveTitle('true false');
  expect(
    warned.filter((text) => text.startsWith('InputError: marching-particles/element is on this page twice')),
  ).toHaveLength(1);
});

test('without SIMD the sampling is rejected with what has it', { tag: '@all' }, async ({ page }) => {
  const modules = { imports: { 'marching-particles': './node_modules/marching-particles/inline.js' } };
  there.write(
    'index.html',
    `<script>WebAssembly.validate = () => false;</script>
<script type="importmap">${JSON.stringify(modules)}</script>
<script type="module">import { sample } from 'marching-particles';
document.title = await sample('x^2 + y^2 + z^2 = 1', { count: 300 }).catch(String);
</script>`,
  );
  await serve(page, '.');
  await expect(page).toHaveTitle(/^WorkerError: There is no WebAssembly SIMD here.*Safari from 16\.4/);
});

test('a view in an element of a page has a state, and rejects what is wrong', { tag: '@all' }, async ({ page }) => {
  const modules = { imports: { 'marching-particles/view': './node_modules/marching-particles/view.js' } };
  there.write(
    'index.html',
    `<script type="importmap">${JSON.stringify(modules)}</script>
<div id="host" style="width: 320px; height: 240px"></div>
<script type="module">import { createView } from 'marching-particles/view';
const view = createView(host, { formula: 'x^2 + y^2 + z^2 = a', count: 400 }, { backend: 'canvas2d' });
const told = [];
const end = view.on('report', ({ count }) => told.push(count));
const { components } = await view.ready;
const moved = await view.set({ params: { a: 2 } });
const wrong = await view.set({ formula: 'x +' }).catch(({ name }) => name);
const none = await view.set({ formula: 'x^2 + y^2 + 1' }).catch(({ name }) => name);
await view.set({ formula: 'x^2 + y^2 + z^2 = 1' });
const { size, type } = await view.picture({ width: 64, height: 48 });
const { points, radii } = view.particles();
end();
view.destroy();
const facts = [view.backend, components, moved.components, wrong, none, size > 100, type, points.length / radii.length, told.length > 1];
document.title = facts.join(' ');
</script>`,
  );
  await serve(page, '.');
  await expect(page).toHaveTitle('canvas2d 1 1 FormulaError NoSurfaceError true image/png 3 true');
});

/** Writes a page with the program as a script of its own. */
function writeProgram() {
  there.write('index.html', '<script type="module" src="./program.js"></script>');
  there.write('program.js', programOf('document.title = '));
}

test('a page that webpack builds samples the same', { tag: '@all' }, async ({ page }) => {
  writeProgram();
  const compiler = webpack({
    context: there.project,
    mode: 'production',
    entry: './program.js',
    output: { path: join(there.project, 'by-webpack'), filename: 'program.js', publicPath: 'auto' },
    experiments: { topLevelAwait: true },
  });
  const stats = await new Promise((resolve, reject) => {
    compiler?.run((error, result) => (error ? reject(error) : resolve(result)));
  });
  expect(stats.compilation.errors).toEqual([]);
  there.write('by-webpack/index.html', '<script src="./program.js"></script>');
  expect(await digestIn(page, 'by-webpack')).toBe(golden.digest);
});

test('a page that esbuild builds samples the same, beside an element', { tag: '@all' }, async ({ page }) => {
  writeProgram();
  // esbuild leaves addresses as they are: what lies beside the script is named.
  await esbuild.build({
    absWorkingDir: there.project,
    entryPoints: {
      program: './program.js',
      element: 'marching-particles/element',
      worker: 'marching-particles/worker',
      'sampling-worker': 'marching-particles/sampling-worker',
      'points-worker': 'marching-particles/points-worker',
      'probe-worker': 'marching-particles/probe-worker',
      core_bg: 'marching-particles/core.wasm',
      points_bg: 'marching-particles/points.wasm',
      'render-webgpu_bg': 'marching-particles/render-webgpu.wasm',
      'render-webgl_bg': 'marching-particles/render-webgl.wasm',
    },
    outdir: 'by-esbuild',
    bundle: true,
    splitting: true,
    format: 'esm',
    loader: { '.wasm': 'copy' },
  });
  const files = readdirSync(join(there.project, 'by-esbuild'));
  const named = files
    .filter((name) => name.endsWith('.js'))
    .flatMap((name) => [
      ...readFileSync(join(there.project, 'by-esbuild', name), 'utf8').matchAll(
        /new URL\("\.\/([^"]+)", import\.meta\.url\)/g,
      ),
    ]);
  expect(named.length).toBeGreaterThan(6);
  expect(files).toEqual(expect.arrayContaining(named.map(([, name]) => name)));
  there.write(
    'by-esbuild/index.html',
    `<marching-particles backend="canvas2d" formula="x^2 + y^2 + z^2 = 1" count="300" style="width: 320px"></marching-particles>
<script type="module" src="./element.js"></script>
<script type="module" src="./program.js"></script>`,
  );
  expect(await digestIn(page, 'by-esbuild')).toBe(golden.digest);
  await expect
    .poll(() =>
      page.evaluate(() => {
        const { view, report } = document.querySelector('marching-particles') ?? {};
        return [view?.backend, report?.components];
      }),
    )
    .toEqual(['canvas2d', 1]);
});

test('a page that Vite builds samples the same', { tag: '@all' }, async ({ page }) => {
  writeProgram();
  const how = {
    root: there.project,
    base: './',
    configFile: /** @type {const} */ (false),
    logLevel: /** @type {const} */ ('warn'),
  };
  await build({ ...how, build: { outDir: 'built', target: 'es2022' }, worker: { format: 'es' } });
  expect(await digestIn(page, 'built')).toBe(golden.digest);
});
