/**
 * The sampler in the thread of the program, in slices: for functions, which cannot leave it.
 *
 * @module
 */

/** @import { Heard, Line, Load } from './protocol.js' */

/**
 * The core of a thread is one: after an error its memory cannot be trusted, and it cannot be loaded
 * again.
 */
let hasFailed = false;

/**
 * Returns what opens a line to a sampler that is loaded when it is asked for the first time.
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
