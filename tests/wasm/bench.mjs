// Times the whole job (front and ten relaxation steps on the ellipsoid) of the core as WebAssembly, in a worker of a
// headless Chromium, as the page runs it.
//
// Usage: node tests/wasm/bench.mjs, after `cargo xtask wasm core`; `cargo xtask bench --web` does both. CHROMIUM_PATH names
// the browser.
import { createReadStream } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import process from 'node:process';
import { fileURLToPath } from 'node:url';

const root = new URL('../../', import.meta.url);
const { chromium } = createRequire(new URL('www/package.json', root))('@playwright/test');

/** Particles asked for: two thicknesses of the paper, and the size that the time per particle must still hold at. */
const COUNTS = [13_923, 55_748, 1_000_000];

/** Runs of each; the fastest counts, since whatever else the machine does only ever adds. */
const RUNS = 3;

/** Runs in the worker; written out as a function so that it is checked as code. */
const worker = `
import init, { Core } from './core.js';
await init();
const start = (core, settings) => {
  const answer = core.start(settings);
  if (answer.ok !== true) throw new Error(JSON.stringify(answer));
};
// The radius that gives the count is found by a front of its own, so that the timed runs do the front once.
const share = (count, max_particles) => {
  const core = new Core();
  start(core, { size_mode: 'count', count, relax_steps: 0, max_particles });
  let progress;
  do progress = core.step(20000);
  while (progress.stop_reason === null);
  const { min, max } = core.describe().surfaces[0].bounds;
  core.free();
  return progress.radius / Math.hypot(...max.map((high, axis) => high - min[axis]));
};
self.onmessage = ({ data: { count, runs } }) => {
  const max_particles = 2 * count;
  const radius_share = share(count, max_particles);
  let best;
  for (let run = 0; run < runs; run += 1) {
    const core = new Core();
    const began = performance.now();
    start(core, { size_mode: 'radius', radius_share, max_particles });
    let front = 0;
    let progress;
    do {
      progress = core.step(20000);
      if (front === 0 && (progress.phase === 'relaxation' || progress.phase === 'done')) front = performance.now() - began;
    } while (progress.stop_reason === null);
    const whole = performance.now() - began;
    if (!best || whole < best.whole) {
      best = { count: core.count(), front, whole, evaluations: progress.evaluations, stop: progress.stop_reason, digest: core.digest() };
    }
    core.free();
  }
  self.postMessage(best);
};
self.postMessage('ready');
`;

const page = '<!doctype html><title>bench</title>';
const files = {
  '/': ['text/html', page],
  '/worker.js': ['text/javascript', worker],
};
const bundle = new Set(['/core.js', '/core_bg.wasm']);

const server = createServer((request, response) => {
  const path = new URL(request.url ?? '/', 'http://localhost').pathname;
  if (path in files) {
    const [type, text] = files[path];
    response.writeHead(200, { 'content-type': type }).end(text);
  } else if (bundle.has(path)) {
    response.writeHead(200, { 'content-type': path.endsWith('.js') ? 'text/javascript' : 'application/wasm' });
    createReadStream(fileURLToPath(new URL(`www/src/wasm/core${path}`, root))).pipe(response);
  } else {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(undefined)));
const address = server.address();
const origin = `http://127.0.0.1:${typeof address === 'object' ? address?.port : ''}/`;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM_PATH || undefined,
  args: [
    '--no-sandbox',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
  ],
});
try {
  const tab = await browser.newPage();
  await tab.goto(origin);
  console.log(`whole job on the ellipsoid, Chromium ${browser.version()}, fastest of ${RUNS}`);
  console.log('  particles  front ms  whole ms  µs/particle  evaluations/particle  digest');
  for (const count of COUNTS) {
    const result = await tab.evaluate(
      ({ count, runs }) =>
        new Promise((resolve, reject) => {
          const worker = new Worker('./worker.js', { type: 'module' });
          worker.onerror = (event) => reject(new Error(event.message || 'the worker failed'));
          worker.onmessage = ({ data }) => {
            if (data === 'ready') {
              worker.postMessage({ count, runs });
            } else {
              worker.terminate();
              resolve(data);
            }
          };
        }),
      { count, runs: RUNS },
    );
    const perParticle = (1000 * result.whole) / result.count;
    const evaluations = result.evaluations / result.count;
    console.log(
      `  ${String(result.count).padStart(9)}${result.front.toFixed(0).padStart(10)}${result.whole.toFixed(0).padStart(10)}` +
        `${perParticle.toFixed(2).padStart(13)}${evaluations.toFixed(2).padStart(22)}  ${result.digest}`,
    );
    if (result.stop !== 'complete') throw new Error(`the run ended with ${result.stop}`);
  }
} finally {
  await browser.close();
  server.close();
}
