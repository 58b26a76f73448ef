/** The worker of the package in a browser. @module */
import { load } from './load.js';
import { serve } from './serve.js';

const answer = serve({
  post: (message, transfer = []) => self.postMessage(message, { transfer: /** @type {Transferable[]} */ (transfer) }),
  load,
});
self.onmessage = ({ data }) => void answer(data);
