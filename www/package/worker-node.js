/** The worker of the package in Node. @module */
import { parentPort } from 'node:worker_threads';
import { load } from './load-node.js';
import { serve } from './serve.js';

const answer = serve({
  post: (message, transfer = []) => parentPort?.postMessage(message, /** @type {any} */ (transfer)),
  load,
});
parentPort?.on('message', (message) => void answer(message));
