/** Workers of the lesson and of the sampler that run in the thread of a test. */
import { readFileSync } from 'node:fs';
import { follow } from '../../../src/engine/lesson/follow.js';
import { runJob } from '../../../src/engine/sampling/job.js';
import { Jobs, measured } from '../../../src/engine/sampling/jobs.js';
import { Core, initSync as initCore } from '../../../src/wasm/core/core.js';
import { initSync, Lesson } from '../../../src/wasm/lesson/lesson.js';

/** Loads the bundles of both, before the first of them begins. */
export function loadWasm() {
  initSync({ module: readFileSync(new URL('../../../src/wasm/lesson/lesson_bg.wasm', import.meta.url)) });
  initCore({ module: readFileSync(new URL('../../../src/wasm/core/core_bg.wasm', import.meta.url)) });
}

/** A worker of the lesson that runs in this thread. @returns {any} */
export function spawn() {
  const worker = {
    onmessage: (/** @type {any} */ _event) => {},
    terminate() {},
    postMessage: (/** @type {any} */ _data) => {},
  };
  const follower = follow(new Lesson(), {
    nowMs: () => performance.now(),
    pause: () => new Promise((resolve) => setTimeout(resolve)),
    post: (data) => queueMicrotask(() => worker.onmessage({ data })),
  });
  worker.postMessage = (data) => void follower.receive(data);
  return worker;
}

/** A worker of the sampler that runs in this thread. @returns {any} */
export function spawnCore() {
  const core = new Core();
  const memory = { held: 0, meshed: 0, gaveUp: false };
  const post = (/** @type {any} */ data) => queueMicrotask(() => worker.onmessage({ data }));
  const jobs = new Jobs(post, () => performance.now());
  const env = {
    nowMs: () => performance.now(),
    pause: () => new Promise((resolve) => setTimeout(resolve)),
    ...{ post, interrupt: () => null, curvature: () => false, mesh: () => false, room: () => true },
  };
  const worker = {
    onmessage: (/** @type {any} */ _event) => {},
    terminate: () => core.free(),
    postMessage(/** @type {any} */ data) {
      if (data.type === 'measure') return post(measured(core, data));
      jobs.add(data.job);
      const job = jobs.take(core);
      if (job) void runJob(core, job, /** @type {any} */ (env), memory);
    },
  };
  post({ type: 'ready', description: core.describe() });
  return worker;
}
