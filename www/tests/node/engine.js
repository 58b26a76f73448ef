/**
 * The engine by itself, in Node: with the real core, each worker in a thread, and the real painter on canvases that nobody
 * sees. Of a browser there is what the engine asks for and no more; what belongs to the page (panels, address, graphics
 * devices) is for the browser tests.
 *
 * @module
 */
import { Worker as Thread } from 'node:worker_threads';
import { afterEach, expect, vi } from 'vitest';
import { createEngine } from '../../src/engine/index.js';
import { createConsole } from '../../src/main/console.js';
import { pictureOf, spotsOf } from '../pixels.js';
import { frames } from './clock.js';
import { fileAt } from './files.js';

export { pause, turn } from './clock.js';

/**
 * @import { Engine, ReadonlySignal } from '../../src/engine/types.js'
 * @import { Console } from '../../src/main/types.js'
 */

/** Size of the picture in pixels. Most of the time of a test is painting them. */
const [WIDTH, HEIGHT] = [160, 120];

/** A link to a state. @param {object} state */
export const link = (state) => `#v1.j.${Buffer.from(JSON.stringify(state)).toString('base64url')}`;

/** A coarse ellipsoid: some 280 particles. */
export const coarse = { settings: { radius_share: 0.02 } };

/** The workers that were started, by name. @type {Record<string, FakeWorker[]>} */
export let workers = {};
/**
 * Brings a fault upon the newest worker of the sampler (`faults.js`).
 * @param {'panic' | 'overflow' | 'hang'} fault
 */
export const strike = (fault) => workers.sampler.at(-1)?.thread.postMessage({ fault });

/** The addresses that were fetched. @type {string[]} */
export let fetched = [];
/** What is answered in place of a file whose address has this part. @type {Map<string, import('./files.js').Answer>} */
export const answers = new Map();

/** A web worker in a thread of Node. */
class FakeWorker {
  /** @type {((event: {data: any}) => void) | null} */
  onmessage = null;
  /** @type {((event: {message: string}) => void) | null} */
  onerror = null;

  /** @param {URL | string} url @param {{name: string}} options */
  constructor(url, { name }) {
    this.thread = new Thread(new URL('./thread.js', import.meta.url), {
      workerData: { url: String(url), answers, navigator: wishes },
    });
    this.thread.on('message', (data) => this.onmessage?.({ data }));
    this.thread.on('error', ({ message }) => this.onerror?.({ message }));
    workers[name] = [...(workers[name] ?? []), this];
  }

  /** @param {any} message @param {any} [transfer] */
  postMessage(message, transfer) {
    // Node forgets the name of a file on its way.
    this.thread.postMessage({ message, name: message.file?.name }, transfer);
  }

  /** Whether it is gone: nothing will come of it any more. */
  isEnded = false;

  terminate() {
    this.isEnded = true;
    void this.thread.terminate();
  }
}

/** Keeps a size that never changes, and sees everything. */
class Observer {
  observe() {}
  disconnect() {}
}

class FakeImage {
  /** @param {[number, number] | [Uint8ClampedArray, number, number]} given  its size, or its pixels and its size */
  constructor(...given) {
    const [width, height] = /** @type {number[]} */ (given.slice(-2));
    const data = typeof given[0] === 'number' ? new Uint8ClampedArray(4 * width * height) : given[0];
    Object.assign(this, { width, height, data });
  }
}

/** A canvas that takes pictures and shows them to nobody; of graphics devices it has none. */
const canvas = () => ({
  style: {},
  setAttribute() {},
  remove() {},
  getContext: (/** @type {string} */ kind) => (kind === '2d' ? { putImageData() {} } : null),
});

const page = Object.assign(new EventTarget(), { hidden: false, createElement: canvas });

/** Makes the page believe that its tab is hidden, or shown again. @param {boolean} hidden */
export function hide(hidden) {
  page.hidden = hidden;
  page.dispatchEvent(new Event('visibilitychange'));
}

/** What the browser says of the user and of itself. */
export const wishes = { reducedMotion: true, userAgent: 'Node' };
const media = (/** @type {string} */ query) =>
  Object.assign(new EventTarget(), { matches: query.includes('motion') && wishes.reducedMotion, onchange: null });

for (const [name, value] of Object.entries({
  Worker: FakeWorker,
  fetch(/** @type {string | URL} */ url) {
    fetched.push(String(url));
    return fileAt(url, answers);
  },
  document: page,
  matchMedia: media,
  ResizeObserver: Observer,
  IntersectionObserver: Observer,
  ImageData: FakeImage,
  devicePixelRatio: 1,
  navigator: wishes,
  location: { origin: 'http://localhost', pathname: '/' },
  requestAnimationFrame: frames.ask,
  cancelAnimationFrame: frames.cancel,
}))
  vi.stubGlobal(name, value);

/** @type {Engine[]} */
let engines = [];
afterEach(() => {
  for (const engine of engines) engine.destroy();
  engines = [];
  workers = {};
  fetched = [];
  answers.clear();
  Object.assign(wishes, { reducedMotion: true, userAgent: 'Node' });
  hide(false);
});

/** An element that the engine draws in and gets its input from. */
export const createHost = () =>
  /** @type {any} */ (
    Object.assign(new EventTarget(), {
      tabIndex: 0,
      clientWidth: WIDTH,
      clientHeight: HEIGHT,
      append() {},
      getBoundingClientRect: () => ({ left: 0, top: 0, width: WIDTH, height: HEIGHT }),
    })
  );

/**
 * Begins an engine with the state of a link, and the console that drives it.
 * @param {string} [hash]
 */
export function begin(hash = link(coarse)) {
  const engine = createEngine({ host: createHost(), link: hash });
  engines.push(engine);
  return createConsole(engine);
}

/** Begins an engine and waits for its first run. @param {string} [hash] */
export async function open(hash) {
  const p = begin(hash);
  await p.ready;
  return p;
}

/**
 * Waits until a signal has a value that is wanted.
 * @template T
 * @param {ReadonlySignal<T>} signal @param {(value: T) => unknown} isWanted
 * @returns {Promise<T>}
 */
export const until = (signal, isWanted) =>
  new Promise((resolve) => {
    const off = signal.subscribe((value) => {
      if (!isWanted(value)) return;
      resolve(value);
      queueMicrotask(() => off());
    });
  });

/** Waits until something holds that no signal tells. @param {() => unknown} isSo */
export const eventually = (isSo) => expect.poll(isSo, { timeout: 60_000, interval: 20 });

/** What is in the picture. @param {Console} p */
export const picture = async (p) => pictureOf(await p.pixels(160, 120));

/** The separate spots in the picture. @param {Console} p */
export const spots = async (p) => spotsOf(await p.pixels(600, 450));

/** The picture shows a surface in many colours, not a blank or a flat one. @param {Console} p */
export async function expectSurface(p) {
  const { drawn, hues, middle, corner } = await picture(p);
  expect(drawn).toBeGreaterThan(0.12);
  expect(drawn).toBeLessThan(0.85);
  expect(hues).toBeGreaterThanOrEqual(6);
  expect(middle.slice(0, 3)).not.toEqual(corner);
}
