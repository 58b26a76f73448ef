/** The worker of the package in Node. @module */
import { readFile } from 'node:fs/promises';
import { parentPort } from 'node:worker_threads';
import init from '../src/wasm/core/core.js';
import { serve } from './serve.js';

const answer = serve({
  post: (message, transfer = []) => parentPort?.postMessage(message, /** @type {any} */ (transfer)),
  // Node hands a port up to 1000 messages in one task: a message to itself would keep others waiting.
  pause: () => new Promise((resolve) => void setImmediate(resolve)),
  load: async () => init({ module_or_path: await readFile(new URL('./core_bg.wasm', import.meta.url)) }),
});
parentPort?.on('message', (message) => void answer(message));
