/**
 * Pauses between two slices of work, so that the thread can receive messages and a page can draw.
 *
 * @module
 */

/** @type {(() => void)[]} */
const waiting = [];
const next = () => waiting.shift()?.();

/** Returns a function that calls `next` in a separate task, sooner than a timer would. */
function messages() {
  const channel = new MessageChannel();
  channel.port1.onmessage = next;
  return () => channel.port2.postMessage(null);
}

// In Node a port delivers up to 1000 messages in one task, so a message to itself would keep others waiting; and an
// open port would keep the program alive.
const resume = typeof setImmediate === 'function' ? () => void setImmediate(next) : messages();

/** @returns {Promise<void>} */
export const pause = () =>
  new Promise((resolve) => {
    waiting.push(resolve);
    resume();
  });
