/** The package in Node. @module */
import { Worker } from 'node:worker_threads';
import { createSampler } from './client.js';
import { openHere } from './here.js';
import { load } from './load-node.js';

export { DisposedError, FieldError, FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';
export { difference, intersection, offset, smoothUnion, union } from './solids.js';

/** @param {import('./protocol.js').Heard} heard @returns {import('./protocol.js').Line} */
function open({ onMessage, onFail }) {
  // Flags of the program, such as --input-type, do not apply to the worker.
  const options = { name: 'marching-particles', execArgv: [] };
  const worker = new Worker(new URL('./worker-node.js', import.meta.url), options);
  worker.on('message', onMessage);
  worker.on('error', ({ message }) => onFail(message));
  return {
    post: (message) => worker.postMessage(message),
    end: () => void worker.terminate(),
    hold: (isHeld) => (isHeld ? worker.ref() : worker.unref()),
  };
}

export const sample = createSampler(open, openHere(load));
