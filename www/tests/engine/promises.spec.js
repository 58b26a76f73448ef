/** Every promise of the console settles, whatever its worker or its device was doing when it died. */
import { expect, test } from '@playwright/test';
import { atRest, expectSurface, open } from './browser.js';

/** What the page is doing when a worker dies, and whose work it is. */
const STATES = {
  'at rest': 'sampler',
  seeding: 'sampler',
  generation: 'sampler',
  relaxation: 'sampler',
  quality: 'sampler',
  'joining a mesh': 'sampler',
  'writing a file': 'sampler',
  'opening a file': 'points',
};

/** @typedef {{state: string, worker: string, death: string}} Row */

/** Runs before the page: notes its workers, so that a test can end them without a word. */
function prepare() {
  const workers = /** @type {Record<string, Worker>} */ ({});
  // Lets a minute pass, so that some deaths in a row are no reason for safe mode.
  const now = performance.now.bind(performance);
  let ahead = 0;
  performance.now = () => now() + ahead;
  window.Worker = class extends Worker {
    /** @param {string | URL} url @param {WorkerOptions} [options] */
    constructor(url, options = {}) {
      super(url, options);
      workers[options.name ?? ''] = this;
    }
  };
  Object.assign(window, { workers, passMinute: () => (ahead += 61_000) });
}

/**
 * Brings the page into a state, lets the worker die there and makes more calls. Runs in the page.
 * @param {Row} row
 * @returns {Promise<string[]>} the calls that are open although nothing has been under way for long
 */
async function attack({ state, worker, death }) {
  const { marchingParticles: p, workers, passMinute } = /** @type {any} */ (window);
  const { engine } = p;
  const pause = (/** @type {number} */ ms) => new Promise((resolve) => setTimeout(resolve, ms));
  /** Points on a ball. @param {number} count */
  const cloud = (count) => {
    const rows = Array.from({ length: count }, (_, k) => {
      const z = (2 * k + 1) / count - 1;
      const r = Math.sqrt(1 - z * z);
      return `${r * Math.cos(2.4 * k)} ${r * Math.sin(2.4 * k)} ${z}`;
    });
    return new File([rows.join('\n')], 'ball.xyz');
  };
  const pending = new Set();
  const call = (/** @type {string} */ name, /** @type {Promise<unknown>} */ promise) => {
    pending.add(name);
    promise.catch(() => {}).then(() => pending.delete(name));
  };
  const isBusy = () => engine.busy.value || engine.progress.value.phase !== 'done';
  const settled = async () => {
    // What a file waits for ends with its worker.
    const isLoading = () => engine.loading.value && worker !== 'points';
    for (let k = 0; pending.size > 0 && k < 200; k = isBusy() || isLoading() ? 0 : k + 1) await pause(50);
  };

  passMinute();
  engine.setView({ draw: state === 'joining a mesh' ? 'mesh' : 'discs' });
  // So much work that every phase is seen, and another input in every state: one that fails twice is given up.
  const relaxSteps = state === 'relaxation' ? 1000 : 30;
  const settings = { radius_share: 0.007, relax_steps: relaxSteps, seed: state.length };
  if (state === 'writing a file') call('exportMesh before', engine.exportMesh('glb'));
  else if (state === 'opening a file') call('open before', p.open(cloud(2000)));
  else if (state !== 'at rest') call('set before', p.set({ surface: 'torus', settings }));
  const rests = ['at rest', 'joining a mesh', 'writing a file'].includes(state);
  await new Promise((resolve, reject) => {
    const look = () => {
      const { phase } = engine.progress.value;
      const stage = engine.loading.value?.stage;
      if (worker === 'points' ? stage === 'solving' : phase === (rests ? 'done' : state)) resolve(true);
    };
    engine.progress.subscribe(look);
    engine.loading.subscribe(look);
    setTimeout(() => reject(new Error(`${state} was not seen`)), 60_000);
  });

  if (death === 'panic') p.debug.panic();
  else workers[worker].terminate();
  // First what nothing else helps to settle.
  call('exportMesh', engine.exportMesh('ply'));
  await settled();
  call('pixels', p.pixels(40, 30));
  call('savePng', engine.savePng({ width: 40, height: 30 }));
  call('still', p.debug.still());
  call('relax', p.relax(1));
  call('open', p.open(cloud(30)));
  await settled();
  call('run', p.run());
  call('set', p.set({ surface: 'ellipsoid', settings: { radius_share: 0.01 } }));
  call('stop', p.stop());
  call('run again', p.run());
  await settled();
  return [...pending];
}

for (const death of ['panic', 'silence']) {
  test(`by a worker’s ${death} in any state no promise stays open`, async ({ page }) => {
    test.slow();
    await page.addInitScript(prepare);
    await open(page);
    for (const [state, worker] of Object.entries(STATES)) {
      // What a panic of the solver does is the same in every stage (points.test.js).
      if (worker === 'points' && death === 'panic') continue;
      expect(await page.evaluate(attack, { state, worker, death }), state).toEqual([]);
    }
    await atRest(page);
    await expectSurface(page);
  });
}

test('without a sampler calls settle too, also when its notice has been dismissed', async ({ page }) => {
  await page.route('**/core_bg*.wasm', (route) => route.fulfill({ status: 404 }));
  await page.goto('/');
  await expect
    .poll(() => page.evaluate(() => /** @type {any} */ (window).marchingParticles?.status().notice?.id))
    .toBe('load');
  const ends = await page.evaluate(async () => {
    const p = /** @type {any} */ (window).marchingParticles;
    p.engine.dismissNotice();
    const calls = [p.ready, p.run(), p.stop(), p.open(new File(['1 2 3'], 'a.xyz')), p.debug.still()];
    return (await Promise.allSettled(calls)).map(({ status }) => status);
  });
  expect(ends).toEqual(['fulfilled', 'fulfilled', 'fulfilled', 'fulfilled', 'fulfilled']);
});

test('a picture whose device is lost, or whose renderer traps, while it is read back is refused', async ({ page }) => {
  await open(page);
  const ends = await page.evaluate(async () => {
    const p = /** @type {any} */ (window).marchingParticles;
    const told = (/** @type {Promise<unknown>} */ promise) => promise.then(String, (error) => error.message);
    const opened = async (/** @type {number} */ count) => {
      while (p.debug.counts().opened < count) await new Promise((resolve) => setTimeout(resolve, 50));
    };
    const ends = [];
    const context = () =>
      /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas')).getContext('webgl2');
    let reading = p.pixels(400, 300);
    context()?.getExtension('WEBGL_lose_context')?.loseContext();
    ends.push(await told(reading));
    await opened(2);
    // The renderer asks for a fence before it reads. What is thrown there leaves it in the state of a panic.
    const { prototype } = WebGL2RenderingContext;
    const { fenceSync } = prototype;
    prototype.fenceSync = () => {
      throw new Error('no fence');
    };
    reading = p.pixels(400, 300);
    ends.push(await told(reading));
    prototype.fenceSync = fenceSync;
    await opened(3);
    return ends;
  });
  expect(ends).toEqual(['the graphics device is lost', 'the graphics device is lost']);
  await expectSurface(page);
});
