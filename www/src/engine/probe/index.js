/**
 * Finds out, once for all pictures of a page, the best way of drawing.
 *
 * @module
 */

import { drawerOn } from './drawer.js';

/**
 * @import { BackendKind } from '../types.js'
 * @import { Drawer } from './types.js'
 */

/** Time after which an answer counts as missing. Until then the picture is painted. */
const LONGEST_MS = 5000;

/** @template T @param {Promise<T>} promise @returns {Promise<T | null>} */
const within = (promise) =>
  Promise.race([
    promise.catch(() => null),
    new Promise((/** @type {(nothing: null) => void} */ resolve) => setTimeout(() => resolve(null), LONGEST_MS)),
  ]);

/** @type {Promise<any> | null} */
let adapter = null;
/** @type {Promise<Drawer> | null} */
let drawer = null;

/** Returns the adapter of WebGPU; null without one. */
export function askAdapter() {
  const gpu = /** @type {any} */ (navigator).gpu;
  // The development server has one renderer by default.
  if (import.meta.env.VITE_WITHOUT_WEBGPU || !gpu) return Promise.resolve(null);
  adapter ??= within(gpu.requestAdapter());
  return adapter;
}

/**
 * Returns what draws WebGL2. In some browsers only the page has it, not a worker; then the page asks itself.
 */
export function askDrawer() {
  drawer ??= within(
    new Promise((resolve, reject) => {
      const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'probe' });
      const end = (/** @type {() => void} */ tell) => {
        worker.terminate();
        tell();
      };
      worker.onmessage = ({ data }) =>
        end(() => resolve(data === 'none' ? drawerOn(() => document.createElement('canvas')) : data));
      worker.onerror = ({ message }) => end(() => reject(new Error(message)));
    }),
  );
  return drawer;
}

/**
 * Returns the best way of drawing: a graphics card if there is one, else the painter. If unknown, a card is assumed.
 * @returns {Promise<BackendKind>}
 */
export async function bestKind() {
  const found = await askAdapter();
  if (found && !(found.info?.isFallbackAdapter ?? found.isFallbackAdapter)) return 'webgpu';
  const kind = await askDrawer();
  return kind === 'card' || kind === null ? 'webgl2' : 'canvas2d';
}
