/** The worker of the package in a browser. @module */
import init from '../src/wasm/core/core.js';
import { serve } from './serve.js';

// A message to itself is a task of its own, and comes sooner than a timer.
const channel = new MessageChannel();
/** @type {(() => void)[]} */
const waiting = [];
channel.port1.onmessage = () => waiting.shift()?.();

const answer = serve({
  post: (message, transfer = []) => self.postMessage(message, { transfer: /** @type {Transferable[]} */ (transfer) }),
  pause: () =>
    new Promise((resolve) => {
      waiting.push(resolve);
      channel.port2.postMessage(null);
    }),
  load: () => init({ module_or_path: new URL('./core_bg.wasm', import.meta.url) }),
});
self.onmessage = ({ data }) => void answer(data);
