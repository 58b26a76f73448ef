/**
 * Opens the graphics back ends, best first. Each gets a new canvas, because a canvas keeps the kind of its first
 * context.
 *
 * @module
 */

/**
 * @import { Renderer } from '../../wasm/render-webgpu/render.js'
 * @import { BackendKind } from '../types.js'
 * @import { Painter } from './painter.js'
 * @import { Device } from './types.js'
 */

/** @type {readonly BackendKind[]} */
export const BACKENDS = ['webgpu', 'webgl2', 'canvas2d'];

/** Time after which a request for an adapter counts as failed. */
const ADAPTER_MS = 5000;

/** A device was lost while it opened: a browser takes the context of one picture for another at any time. */
export class DeviceLost extends Error {}

/** @template T @param {Promise<T>} promise @param {number} ms @returns {Promise<T | null>} */
const within = (promise, ms) => Promise.race([promise, new Promise((resolve) => setTimeout(() => resolve(null), ms))]);

/** Returns whether the browser supports a back end, so that its bundle is worth fetching. @param {BackendKind} kind */
async function available(kind) {
  if (kind === 'canvas2d') return true;
  if (kind === 'webgpu') {
    // The development server has one renderer, unless it is asked for both.
    if (import.meta.env.VITE_WITHOUT_WEBGPU) return false;
    const gpu = /** @type {any} */ (navigator).gpu;
    if (!gpu) return false;
    try {
      return (await within(gpu.requestAdapter(), ADAPTER_MS)) !== null;
    } catch {
      return false;
    }
  }
  hasWebgl ??= probed();
  return hasWebgl;
}

/** Whether there is WebGL2; null before it was tried. @type {boolean | null} */
let hasWebgl = null;

/** Returns whether there is WebGL2. Each try costs a context, which a browser may take from another picture. */
function probed() {
  const probe = document.createElement('canvas').getContext('webgl2');
  probe?.getExtension('WEBGL_lose_context')?.loseContext();
  return probe !== null;
}

/** @param {'webgpu' | 'webgl2'} kind */
const bundle = (kind) =>
  kind === 'webgpu' ? import('../../wasm/render-webgpu/render.js') : import('../../wasm/render-webgl/render.js');

/**
 * Opens a device of this kind on a new canvas in `host`.
 * @param {BackendKind} kind
 * @param {HTMLElement} host
 * @param {{onLost: (reason: string, message: string) => void, onError: (message: string) => void}} events  callbacks of
 *   this device only
 * @param {Promise<unknown>} [after]  what the bundle is fetched after; the adapter is asked for at once
 * @returns {Promise<Device>}
 * @throws {DeviceLost} if the device was lost meanwhile
 * @throws if the browser lacks the back end or its bundle fails to start
 */
export async function openDevice(kind, host, events, after) {
  if (!(await available(kind))) throw new Error(`${kind} is not available`);
  const canvas = document.createElement('canvas');
  Object.assign(canvas.style, {
    position: 'absolute',
    inset: '0',
    width: '100%',
    height: '100%',
    display: 'block',
    touchAction: 'none',
  });
  canvas.setAttribute('aria-hidden', 'true');
  let closed = false;
  const lost = (/** @type {string} */ reason, /** @type {string} */ message) => {
    // A loss that the page caused itself is not reported. The report is deferred, because the renderer may be in the
    // middle of a call.
    queueMicrotask(() => {
      if (!closed && reason !== 'destroyed') events.onLost(reason, message);
    });
  };
  host.append(canvas);
  /** Whether the renderer was asked for a context of the canvas. */
  let isAsked = false;
  try {
    /** @type {Renderer | Painter} */
    let renderer;
    if (kind === 'canvas2d') {
      const { Painter } = await import('./painter.js');
      renderer = await Painter.create(canvas);
    } else {
      await after;
      const { default: init, Renderer: Made } = await bundle(kind);
      await init();
      isAsked = kind === 'webgl2';
      renderer = await Made.create(canvas, lost, (/** @type {string} */ message) => {
        queueMicrotask(() => {
          if (!closed) events.onError(message);
        });
      });
    }
    return {
      kind,
      canvas,
      renderer,
      dispose() {
        closed = true;
        try {
          renderer.destroy();
          renderer.free();
        } catch {
          // A trapped instance cannot be freed. Removing the canvas releases its resources.
        }
        canvas.remove();
      },
    };
  } catch (error) {
    closed = true;
    canvas.remove();
    if (isAsked && canvas.getContext('webgl2')?.isContextLost()) throw new DeviceLost(String(error));
    throw error;
  }
}
