/** The package in a browser, and for bundlers that target one. @module */
import { createSampler } from './client.js';
import { openHere } from './here.js';
import { load } from './load.js';

export { DisposedError, FieldError, FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';
export { difference, intersection, offset, smoothUnion, union } from './solids.js';

/** @param {import('./protocol.js').Heard} heard @returns {import('./protocol.js').Line} */
function open({ onMessage, onFail }) {
  const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'marching-particles' });
  worker.onmessage = ({ data }) => onMessage(data);
  worker.onerror = ({ message }) => onFail(message || 'its script did not load');
  return { post: (message) => worker.postMessage(message), end: () => worker.terminate(), hold: () => {} };
}

export const sample = createSampler(open, openHere(load));
