/**
 * Lets the thread hear its messages, and a page draw, between two slices of work.
 *
 * @module
 */

/** @type {(() => void)[]} */
const waiting = [];
const next = () => waiting.shift()?.();

/** Returns a function that has `next` called in a task of its own, sooner than by a timer. */
function messages() {
  const channel = new MessageChannel();
  channel.port1.onmessage = next;
  return () => channel.port2.postMessage(null);
}

// Node hands a port up to 1000 messages in one task: a message to itself would keep others waiting,
// and an open port would keep the program alive.
const resume = typeof setImmediate === 'function' ? () => void setImmediate(next) : messages();

/** @returns {Promise<void>} */
export const pause = () =>
  new Promise((resolve) => {
    waiting.push(resolve);
    resume();
  });
