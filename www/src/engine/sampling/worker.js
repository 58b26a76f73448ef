/**
 * The sampler's worker: loads the core, runs one job at a time, the latest one. A trapped core is never called again: the
 * worker says so and waits to be replaced.
 *
 * The core comes in two parts. With the first, which takes half as long to come, uniform fronts grow on the surface of a
 * formula; the rest joins it when it is there, and what needs it waits for it. What calls it earlier all the same (a mistake in
 * the formula, a surface that is hard to find) brings it within the call.
 *
 * @module
 */
import init, { Core, join, whenMissing } from '../../wasm/core/core.js';
import wasmUrl from '../../wasm/core/core_bg.wasm?url';
import restUrl from '../../wasm/core/core_rest.wasm?url';
import description from '../../wasm/core/description.json';
import { curvatureColumn, runJob } from './job.js';
import { Jobs } from './jobs.js';
import { LoadError, loadModule, moduleNow, words } from './load.js';
import { BEAT_MS } from './protocol.js';

/**
 * @typedef {import('./protocol.js').FromWorker} FromWorker
 * @typedef {import('./protocol.js').ToWorker} ToWorker
 * @typedef {import('./protocol.js').Job} Job
 */

/** Most that a run may take with its report: a browser ends a page that takes much more, on a phone much sooner. */
const MEMORY_MB = { desk: 512, phone: 256 };

/** @param {Navigator & {userAgentData?: {mobile: boolean}, deviceMemory?: number}} device */
const onPhone = ({ userAgentData, deviceMemory = 8, userAgent }) =>
  (userAgentData?.mobile ?? /Mobi/.test(userAgent)) || deviceMemory < 4;

/** @param {FromWorker} message @param {Transferable[]} [transfer] */
const post = (message, transfer = []) => self.postMessage(message, { transfer });

const jobs = new Jobs(post, description.later);
/** @type {Job | null} */
let running = null;
/** Pictures under way to the page. */
let undrawn = 0;
/** @type {import('./protocol.js').Fault | null} */
let provoked = null;
/** Whether the page shows the curvature. */
let curvature = false;
let dead = false;
/** The last words of the core's panic hook, which writes to the console. */
let last_words = '';

const say = console.error.bind(console);
console.error = (...parts) => {
  last_words = parts.map(String).join(' ').slice(0, 4000);
  say(...parts);
};

// A message to oneself ends the task, so that waiting messages are handled; timers would be held back to 4 ms.
const self_channel = new MessageChannel();
/** @type {(() => void) | null} */
let resume = null;
self_channel.port1.onmessage = () => {
  const go = resume;
  resume = null;
  go?.();
};
/** @returns {Promise<void>} */
const pause = () =>
  new Promise((resolve) => {
    resume = resolve;
    self_channel.port2.postMessage(null);
  });

/** @type {Core | null} */
let core = null;
/** @type {import('../../wasm/core/core.js').InitOutput | null} */
let raw = null;
const memory = { held: 0 };
/** The rest of the core while it is under way. @type {Promise<void> | null} */
let rest = null;
/** Has a wait for the rest end early. @type {(() => void) | null} */
let wake = null;

/** The rest of the core, or a message that may change what is to be done; null if it is there. @returns {Promise<void> | null} */
function restOrMessage() {
  if (!rest) return null;
  const beat = setInterval(() => post({ type: 'beat' }), BEAT_MS);
  const message = new Promise((/** @type {(nothing: void) => void} */ resolve) => {
    wake = () => resolve();
  });
  return Promise.race([rest, message]).finally(() => {
    clearInterval(beat);
    wake = null;
  });
}

/** Does what tests ask for: a real trap in the instance, or an endless loop. */
function provoke() {
  const fault = provoked;
  provoked = null;
  if (fault === 'hang') for (;;);
  // An object's address far outside the memory traps on its first use, and leaves the instance as a panic does.
  if (fault === 'panic') /** @type {any} */ (raw).core_count(0x7ffffff0);
  if (fault === 'overflow') {
    /** @returns {number} */
    const deeper = () => 1 + deeper();
    deeper();
  }
}

let pumping = false;
async function pump() {
  if (pumping) return;
  pumping = true;
  while (core && !dead) {
    const ours = core;
    try {
      if (rest && jobs.awaitsRest(ours)) {
        if (!jobs.endStopped()) await restOrMessage();
        continue;
      }
      running = jobs.take(ours);
      if (!running) break;
      undrawn = 0;
      await runJob(
        ours,
        running,
        {
          now_ms: () => performance.now(),
          pause,
          post: (message, transfer) => {
            if (message.type === 'columns') undrawn += 1;
            post(message, transfer);
          },
          interrupt: () => {
            if (provoked) provoke();
            return jobs.interrupt(ours, rest === null);
          },
          curvature: () => curvature,
          room: () => undrawn < 2,
          rest: restOrMessage,
        },
        memory,
      );
    } catch (error) {
      crashed(running?.id ?? 0, error);
    }
    running = null;
  }
  pumping = false;
}

/** @param {number} id @param {unknown} error */
function crashed(id, error) {
  dead = true;
  const stack = error instanceof Error ? (error.stack ?? '') : '';
  post({ type: 'crashed', id, message: last_words || words(error), stack: stack.slice(0, 4000) });
}

self.onmessage = (/** @type {MessageEvent<ToWorker>} */ { data }) => {
  if (dead) return;
  switch (data.type) {
    case 'job':
      jobs.add(data.job);
      wake?.();
      void pump();
      break;
    case 'curvature':
      curvature = data.on;
      if (curvature && core && !running && memory.held > 0) {
        try {
          post(...curvatureColumn(core, memory.held));
        } catch (error) {
          crashed(memory.held, error);
        }
      }
      break;
    case 'stop':
      jobs.stop();
      wake?.();
      break;
    case 'drawn':
      if (running && data.id === running.id) undrawn = Math.max(0, undrawn - 1);
      break;
    case 'provoke':
      provoked = data.fault;
      if (!running) {
        try {
          provoke();
        } catch (error) {
          crashed(0, error);
        }
      }
      break;
    default:
  }
};

/** @param {unknown} error */
function failed(error) {
  dead = true;
  const fault = error instanceof LoadError ? error.fault : 'init';
  post({ type: 'failed', fault, message: words(error) });
}

async function loadRest() {
  try {
    join(await loadModule(restUrl, 'second half of the sampler'));
  } catch (error) {
    failed(error);
  }
  rest = null;
}

async function boot() {
  const beat = setInterval(() => post({ type: 'beat' }), BEAT_MS);
  try {
    const module = await loadModule(wasmUrl);
    try {
      raw = await init({ module_or_path: module });
      whenMissing(() => {
        post({ type: 'waiting' });
        return moduleNow(restUrl);
      });
      core = new Core();
      core.limit_memory(MEMORY_MB[onPhone(navigator) ? 'phone' : 'desk']);
      rest = loadRest();
      post({
        type: 'ready',
        description: /** @type {import('../types.js').Description} */ (/** @type {unknown} */ (description)),
      });
    } catch (error) {
      throw new LoadError('init', `The sampler did not start: ${last_words || words(error)}`);
    }
  } catch (error) {
    failed(error);
  } finally {
    clearInterval(beat);
  }
  await pump();
}

void boot();
