/**
 * A core of the browser tests in the browser that `ENGINE` names: `firefox`, from `FIREFOX_PATH`, or `webkit`, from
 * `WEBKIT_DRIVER` and `WEBKIT_BROWSER`. They drive the page by its console, as the browsers differ in nothing that it
 * hides.
 */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { createSite } from '../server.js';
import { firefox, webkit } from './drivers.js';

/** @import { Tab } from './drivers.js' */

const PORT = 4519;
const SITE = `http://localhost:${PORT}/sub/path/`;
/** The same site, whose sampler tests can bring down. */
const FAULTY = `http://localhost:${PORT}/faults/`;
/** A link to a state. @param {object} state */
const link = (state) => `#v1.j.${Buffer.from(JSON.stringify(state)).toString('base64url')}`;
/** About 1,100 particles, which software draws quickly. */
const COARSE = link({ settings: { radius_share: 0.01 } });

/** @type {Tab} */
let tab;
/** What the pages are asked to draw by: WebGL2 where the browser has it, which Firefox without a screen has not. */
let drawing = /** @type {'webgl2' | 'canvas2d'} */ ('webgl2');
const server = createSite();

before(async () => {
  const { ENGINE, FIREFOX_PATH = '', WEBKIT_DRIVER = '', WEBKIT_BROWSER = '' } = process.env;
  await new Promise((done) => server.listen(PORT, 'localhost', () => done(undefined)));
  tab = ENGINE === 'webkit' ? await webkit(WEBKIT_DRIVER, WEBKIT_BROWSER) : await firefox(FIREFOX_PATH);
  await tab.go('about:blank');
  if (!(await tab.run(() => document.createElement('canvas').getContext('webgl2') !== null))) drawing = 'canvas2d';
  console.log(`# ${tab.version}, by ${drawing}`);
});
after(async () => {
  shutDown();
  await tab?.close();
});

function shutDown() {
  server.closeAllConnections();
  server.close();
}

/**
 * Opens the page anew, expects that it draws as it is asked to, and returns the report of its first run.
 * @param {string} hash @param {{site?: string, backend?: typeof drawing}} [how]
 */
async function open(hash, { site = SITE, backend = drawing } = {}) {
  await tab.go('about:blank');
  await tab.go(`${site}?backend=${backend}${hash}`);
  const report = await tab.run(async () => {
    while (!(/** @type {any} */ (window).marchingParticles)) await new Promise((resolve) => setTimeout(resolve, 50));
    const p = /** @type {any} */ (window).marchingParticles;
    const late = () => Promise.reject(new Error(`not ready after 90 s: ${JSON.stringify(p.status())}`));
    return Promise.race([p.ready, new Promise((resolve) => setTimeout(resolve, 90_000)).then(late)]);
  });
  assert.equal((await status()).backend, backend);
  return report;
}

/** @returns {Promise<{backend: string, notice: object | null}>} */
const status = () => tab.run(() => /** @type {any} */ (window).marchingParticles.status());

/** Returns how many pixels of a small picture have a colour: ground and surface to come have none. */
const coloured = () =>
  tab.run(async () => {
    const { pixels } = await /** @type {any} */ (window).marchingParticles.pixels(160, 120);
    let count = 0;
    for (let k = 0; k < pixels.length; k += 4) {
      const [r, g, b] = pixels.subarray(k, k + 3);
      if (Math.max(r, g, b) - Math.min(r, g, b) >= 20) count += 1;
    }
    return count;
  });

test('the page samples and draws', async () => {
  const report = await open(COARSE);
  assert.ok(report.count > 500, `${report.count} particles`);
  assert.equal((await status()).notice, null);
  assert.ok((await coloured()) > 1000);
});

test('the page samples and paints', async () => {
  const report = await open(COARSE, { backend: 'canvas2d' });
  assert.ok(report.count > 500, `${report.count} particles`);
  assert.equal((await status()).notice, null);
  assert.ok((await coloured()) > 1000);
});

test('the particles have the same bits as natively', async () => {
  const golden = new URL('../../../tests/golden/digests.json', import.meta.url);
  const { runs, models } = JSON.parse(await readFile(golden, 'utf8'));
  for (const { name, field, model, pulls, settings, count, digest } of [...runs, ...models]) {
    const report = await open(link({ surface: model, ...field, pulls, settings }), { backend: 'canvas2d' });
    assert.deepEqual({ count: report.count, digest: report.digest }, { count, digest }, name);
  }
});

test('levels are shown one by one', async () => {
  await open(COARSE);
  const all = await coloured();
  await tab.run(() => {
    const { engine, state, particles } = /** @type {any} */ (window).marchingParticles;
    const [x, y, z] = particles().normals;
    // On the side of the seed. Without `fit` the camera does not frame the front.
    const camera = { ...state.view.camera, yaw: Math.atan2(y, x), pitch: Math.asin(z), fit: false };
    engine.setView({ level: 1, camera });
  });
  const few = await coloured();
  assert.ok(few > 10 && few < all / 2, `${few} of ${all} pixels`);
});

test('a link brings the same particles back', async () => {
  const given = { formula: 'x^4+y^4+z^4-1', settings: { radius_share: 0.012, seed: 5 } };
  const { digest, hash } = await tab.run(async (state) => {
    const report = await /** @type {any} */ (window).marchingParticles.set(state);
    return {
      digest: report.digest,
      hash: new URL(await /** @type {any} */ (window).marchingParticles.link()).hash,
    };
  }, given);
  assert.equal((await open(hash)).digest, digest);
});

test('a sampler that traps is replaced, with the surface intact', async () => {
  const { digest } = await open(COARSE, { site: FAULTY });
  const again = await tab.run(async () => {
    const p = /** @type {any} */ (window).marchingParticles;
    new BroadcastChannel('faults').postMessage('panic');
    while (p.debug.counts().restarts === 0) await new Promise((resolve) => setTimeout(resolve, 20));
    const report = await p.run();
    return { digest: report.digest, restarts: p.debug.counts().restarts, cause: p.engine.notice.value?.id };
  });
  assert.deepEqual(again, { digest, restarts: 1, cause: 'panic' });
});

test('a lost device is opened again', async () => {
  await open(COARSE);
  const opened = await tab.run(async () => {
    const p = /** @type {any} */ (window).marchingParticles;
    const before = p.debug.counts().opened;
    p.debug.loseDevice();
    for (let k = 0; k < 200 && p.debug.counts().opened === before; k += 1)
      await new Promise((resolve) => setTimeout(resolve, 50));
    await p.run();
    return p.debug.counts().opened - before;
  });
  assert.equal(opened, 1);
  assert.ok((await coloured()) > 1000);
});

test('without its server the page opens, with all that it needs', async () => {
  await open(COARSE);
  await tab.run(async () => {
    while (navigator.serviceWorker.controller?.state !== 'activated')
      await new Promise((resolve) => setTimeout(resolve, 50));
  });
  shutDown();
  const report = await open(link({ surface: 'bunny', settings: { radius_share: 0.01 } }));
  assert.ok(report.count > 500, `${report.count} particles`);
});
