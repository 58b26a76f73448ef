/**
 * Hours in a few minutes: after many resamplings the page holds no more memory than after the first ones. `SOAK` sets
 * their number: `SOAK=5000 npx playwright test` takes half an hour and more.
 */
import { expect, test } from '@playwright/test';
import { open } from './browser.js';

const TIMES = Number(process.env.SOAK);
/**
 * Resamplings before the first look: buffers have grown to their sizes then. In a long soak there are more, so that V8
 * has compiled what is called often, and the wasm memory has seen most of the moments at which a run can be given up.
 */
const WARM = Math.max(60, TIMES / 5);
/**
 * What the page and its tools may hold more than before, in bytes. Without a long beginning 5,000 resamplings leave 1.1
 * MB more: heap snapshots show that 0.8 MB of it is machine code, which comes within the first 1,000, and no objects
 * are.
 */
const MOST_HEAP = 4e6;
/**
 * The wasm memory may grow by this many bytes. It never shrinks, so its size is the peak of all runs, which depends on
 * where runs are given up: it was between 17.4 and 18.0 MB after the first 60 resamplings, and 17.6 and 18.3 MB after
 * 5,000.
 */
const MOST_WASM = 1e6;

/** Lets the worker's wasm memory be seen from outside; runs in the worker. */
function showMemory() {
  const { Instance, instantiate } = WebAssembly;
  const keep = (/** @type {WebAssembly.Instance} */ instance) => {
    /** @type {any} */ (globalThis).shown = instance.exports.memory;
    return instance;
  };
  WebAssembly.Instance = /** @type {any} */ (
    new Proxy(Instance, { construct: (target, given) => keep(Reflect.construct(target, given)) })
  );
  WebAssembly.instantiate = /** @type {any} */ (
    async (/** @type {any[]} */ ...given) => {
      const made = /** @type {any} */ (await Reflect.apply(instantiate, WebAssembly, given));
      keep(made.instance ?? made);
      return made;
    }
  );
}

/** Counts the bytes of all WebGL buffers; runs in the page. */
function countBuffers() {
  const { prototype } = WebGL2RenderingContext;
  const { bindBuffer, bufferData, deleteBuffer } = prototype;
  /** @type {Map<WebGLBuffer, number>} */
  const sizes = new Map();
  /** @type {Map<number, WebGLBuffer | null>} */
  const bound = new Map();
  prototype.bindBuffer = function (target, buffer) {
    bound.set(target, buffer);
    bindBuffer.call(this, target, buffer);
  };
  prototype.bufferData = /** @type {any} */ (
    /** @this {WebGL2RenderingContext} */
    function (/** @type {any[]} */ ...given) {
      const [target, data] = given;
      const buffer = bound.get(target);
      if (buffer) sizes.set(buffer, typeof data === 'number' ? data : (data?.byteLength ?? 0));
      return Reflect.apply(bufferData, this, given);
    }
  );
  prototype.deleteBuffer = function (buffer) {
    if (buffer) sizes.delete(buffer);
    deleteBuffer.call(this, buffer);
  };
  /** @type {any} */ (window).bufferBytes = () => [...sizes.values()].reduce((sum, size) => sum + size, 0);
}

test(`${TIMES} resamplings leave wasm memory, JavaScript's heap and the buffers of the device as they are`, async ({
  page,
}) => {
  test.setTimeout(120_000 + (WARM + TIMES) * 2000);
  await page.setViewportSize({ width: 160, height: 120 });
  await page.addInitScript(countBuffers);
  await page.route(/worker-[^/]*\.js$/, async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, body: `(${showMemory})();\n${await response.text()}` });
  });
  await open(page);
  /** @param {number} times */
  const resample = (times) =>
    page.evaluate(async (count) => {
      const p = /** @type {any} */ (window).marchingParticles;
      const surfaces = ['ellipsoid', 'torus', 'plane'];
      const figures = () =>
        new Promise((resolve) => {
          const last = p.engine.report.value;
          const off = p.engine.report.subscribe((/** @type {object | null} */ report) => {
            if (report && report !== last) setTimeout(() => resolve(off()));
          });
        });
      for (let k = 0; k < count; k += 1) {
        const settings = { radius_share: 0.03 + 0.001 * (k % 5), sampling: k % 4 ? 'uniform' : 'adaptive' };
        const shown = p.set({ surface: surfaces[k % 3], settings, view: { draw: k % 20 ? 'discs' : 'mesh' } });
        // The picture is waited for now and then, so that it does not fall behind.
        await (k % 5 ? figures() : shown);
      }
    }, times);
  const tools = await page.context().newCDPSession(page);
  const held = async () => {
    await tools.send('HeapProfiler.collectGarbage');
    const { usedSize } = await tools.send('Runtime.getHeapUsage');
    const worker = page.workers().find((each) => /worker-/.test(each.url()));
    const wasm = await worker?.evaluate(() => /** @type {any} */ (globalThis).shown?.buffer.byteLength);
    return { heap: usedSize, wasm, buffers: await page.evaluate(() => /** @type {any} */ (window).bufferBytes()) };
  };
  await resample(WARM);
  const before = await held();
  expect(before.wasm).toBeGreaterThan(1e6);
  expect(before.buffers).toBeGreaterThan(1e4);
  await resample(TIMES);
  const after = await held();
  console.log(`${TIMES} resamplings: ${JSON.stringify(before)} → ${JSON.stringify(after)}`);
  expect(after.wasm).toBeLessThan(before.wasm + MOST_WASM);
  expect(after.heap).toBeLessThan(before.heap + MOST_HEAP);
  expect(after.buffers).toBe(before.buffers);
});
