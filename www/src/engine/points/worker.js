/**
 * The worker that turns points into a field. It takes one order, answers it and waits to be terminated.
 *
 * @module
 */
import init, { Points } from '../../wasm/points/points.js';
import { crashWords } from '../bundle/crash.js';
import { loadModule, words } from '../bundle/load.js';
import { BEAT_MS } from './protocol.js';
import { solve } from './solve.js';

/** @import { FromPoints, Order } from './types.js' */

const wasmUrl = new URL('../../wasm/points/points_bg.wasm', import.meta.url);

/** @param {FromPoints} message @param {Transferable[]} [transfer] */
const post = (message, transfer = []) => self.postMessage(message, { transfer });

const crashOf = crashWords();

self.onmessage = async (/** @type {MessageEvent<Order>} */ { data: order }) => {
  // The bundle and the file may take long to load; this shows the page that the worker is alive.
  setInterval(() => post({ type: 'beat' }), BEAT_MS);
  post({ type: 'progress', label: 'Starting', fraction: 0 });
  let points;
  try {
    await init({ module_or_path: await loadModule(wasmUrl, 'solver for points') });
    points = new Points();
  } catch (error) {
    post({ type: 'failed', message: words(error) });
    return;
  }
  try {
    await solve(points, order, {
      nowMs: () => performance.now(),
      pause: () => new Promise((resolve) => setTimeout(resolve)),
      post,
    });
  } catch (error) {
    post({ type: 'crashed', ...crashOf(error) });
  }
};
