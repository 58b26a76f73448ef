/** A thread of Node in the place of a web worker: gives the script what it finds in a browser, and runs it. */
import { File } from 'node:buffer';
import { parentPort, workerData } from 'node:worker_threads';
import { fileAt } from './files.js';

/** @type {Record<string, any>} */
const worker = globalThis;
worker.self = worker;
worker.postMessage = (/** @type {unknown} */ message, /** @type {{transfer: any}} */ { transfer }) =>
  parentPort?.postMessage(message, transfer);
Object.defineProperty(worker, 'navigator', { value: workerData.navigator });
// Node hands a port up to 1000 messages in one task, so that a worker that writes to itself would hear of nothing else
// for seconds. In a browser each is a task.
worker.MessageChannel = class {
  /** @type {{onmessage: ((event: {data: unknown}) => void) | null}} */
  port1 = { onmessage: null };
  port2 = { postMessage: (/** @type {unknown} */ data) => void setImmediate(() => this.port1.onmessage?.({ data })) };
};
worker.fetch = (/** @type {string | URL} */ url) => fileAt(url, workerData.answers);

await import('../faults.js');
await import(workerData.url);
parentPort?.on('message', ({ fault, message, name }) => {
  if (fault) worker.strike(fault);
  else worker.onmessage({ data: name ? { ...message, file: new File([message.file], name) } : message });
});
