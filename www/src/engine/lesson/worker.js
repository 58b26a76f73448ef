/**
 * The worker of the lesson. It loads its bundle with the first message.
 *
 * @module
 */
import init, { Lesson } from '../../wasm/lesson/lesson.js';
import wasmUrl from '../../wasm/lesson/lesson_bg.wasm?url';
import { loadModule, words } from '../bundle/load.js';
import { follow } from './follow.js';

/** @import { FromLesson, ToLesson } from './types.js' */

/** @param {FromLesson} message @param {Transferable[]} [transfer] */
const post = (message, transfer = []) => self.postMessage(message, { transfer });

/** The last message of the bundle's panic hook, which writes to the console. */
let lastWords = '';
const say = console.error.bind(console);
console.error = (...parts) => {
  lastWords = parts.map(String).join(' ').slice(0, 4000);
  say(...parts);
};

/** @type {Promise<ReturnType<typeof follow>> | null} */
let follower = null;

async function load() {
  await init({ module_or_path: await loadModule(wasmUrl, 'lesson') });
  return follow(new Lesson(), {
    nowMs: () => performance.now(),
    pause: () => new Promise((resolve) => setTimeout(resolve)),
    post,
  });
}

self.onmessage = async (/** @type {MessageEvent<ToLesson>} */ { data }) => {
  let ready;
  try {
    follower ??= load();
    ready = await follower;
  } catch (error) {
    post({ type: 'failed', message: words(error) });
    return;
  }
  try {
    await ready.receive(data);
  } catch (error) {
    const stack = error instanceof Error ? (error.stack ?? '').slice(0, 4000) : '';
    post({ type: 'crashed', message: lastWords || words(error), stack });
  }
};
