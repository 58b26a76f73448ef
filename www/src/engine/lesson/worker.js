/**
 * The worker of the lesson. It loads its bundle with the first message.
 *
 * @module
 */
import init, { Lesson } from '../../wasm/lesson/lesson.js';
import { crashWords } from '../bundle/crash.js';
import { loadModule, words } from '../bundle/load.js';
import { follow } from './follow.js';

/** @import { FromLesson, ToLesson } from './types.js' */

const wasmUrl = new URL('../../wasm/lesson/lesson_bg.wasm', import.meta.url);

/** @param {FromLesson} message @param {Transferable[]} [transfer] */
const post = (message, transfer = []) => self.postMessage(message, { transfer });

const crashOf = crashWords();

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
    post({ type: 'crashed', ...crashOf(error) });
  }
};
