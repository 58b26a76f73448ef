/**
 * The sampler in the program's own thread, in slices, for functions, which cannot be sent to a worker.
 *
 * @module
 */

/** @import { Heard, Line, Load } from './protocol.js' */

/**
 * A thread has only one core. After an error its memory cannot be trusted, and it cannot be loaded again.
 */
let hasFailed = false;

/**
 * Returns a function that opens a line to a sampler, which is loaded with its first request.
 * @param {Load} load
 * @returns {(heard: Heard) => Line}
 */
export const openHere =
  (load) =>
  ({ onMessage, onFail }) => {
    if (hasFailed)
      throw new Error('the core of this thread has failed before. Reload the page, or restart the program.');
    const answer = import('./serve.js').then(({ serve }) => serve({ post: onMessage, load }));
    answer.catch((error) => onFail(error.message));
    return {
      post: (message) => void answer.then((ask) => ask(message)).catch(() => {}),
      end: () => {
        hasFailed = true;
      },
      hold: () => {},
    };
  };
