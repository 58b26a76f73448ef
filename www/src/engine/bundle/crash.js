/**
 * Says why a worker has crashed.
 *
 * @module
 */
import { words } from './load.js';

/** Largest length of a message or a stack. */
const MOST = 4000;

/**
 * Listens to the panic hook of the worker's bundle, which writes to the console. Returns a function that describes an
 * error by the hook's last message, or else by the error's own.
 */
export function crashWords() {
  let last = '';
  const say = console.error.bind(console);
  console.error = (...parts) => {
    last = parts.map(String).join(' ').slice(0, MOST);
    say(...parts);
  };
  return (/** @type {unknown} */ error) => ({
    message: last || words(error),
    stack: error instanceof Error ? (error.stack ?? '').slice(0, MOST) : '',
  });
}
