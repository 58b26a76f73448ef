/**
 * Starts the sampler's workers and passes the core to each. The page fetches the core, not the worker: the built page
 * preloads it in parallel with the scripts, and a replacement worker need not fetch it again.
 *
 * @module
 */
import { LoadError, loadModule, words } from '../bundle/load.js';

/** @import { ToWorker } from './types.js' */

const coreUrl = new URL('../../wasm/core/core_bg.wasm', import.meta.url);

/** The compiled core; null before the first worker and after a failure. @type {Promise<WebAssembly.Module> | null} */
let core = null;

export function spawnSampler() {
  const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'sampler' });
  const say = (/** @type {ToWorker} */ message) => worker.postMessage(message);
  core ??= loadModule(coreUrl);
  core.then(
    (module) => say({ type: 'core', module }),
    (error) => {
      core = null;
      say({ type: 'no_core', fault: error instanceof LoadError ? error.fault : 'init', message: words(error) });
    },
  );
  return worker;
}
