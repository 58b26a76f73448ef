/**
 * Opens the graphics back ends, best first. Each gets a new canvas, because a canvas keeps the kind of its first
 * context.
 *
 * @module
 */

import { hasSimd } from '../bundle/load.js';
import { askAdapter, askDrawer } from '../probe/index.js';

/**
 * @import { Renderer } from '../../wasm/render-webgpu/render.js'
 * @import { BackendKind } from '../types.js'
 * @import { Painter } from './painter.js'
 * @import { Device } from './types.js'
 */

/** @type {readonly BackendKind[]} */
export const BACKENDS = ['webgpu', 'webgl2', 'canvas2d'];

/** A device was lost while opening: a browser may take the context from one picture for another at any time. */
export class DeviceLost extends Error {}

/** Returns whether the browser supports a back end, so that its bundle is worth fetching. @param {BackendKind} kind */
async function available(kind) {
  // The renderers are compiled with SIMD, as the core is.
  if (kind !== 'canvas2d' && !hasSimd()) return false;
  if (kind === 'webgpu') return (await askAdapter()) !== null;
  return kind === 'canvas2d' || (await askDrawer()) !== 'none';
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
 * @returns {Promise<Device>}
 * @throws {DeviceLost} if the device was lost meanwhile
 * @throws if the browser lacks the back end or its bundle fails to start
 */
export async function openDevice(kind, host, events) {
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
    // A loss caused by the page itself is not reported. The report is deferred, because the renderer may be in the
    // middle of a call.
    queueMicrotask(() => {
      if (!closed && reason !== 'destroyed') events.onLost(reason, message);
    });
  };
  host.append(canvas);
  /** Whether the renderer has requested a context of the canvas. */
  let isAsked = false;
  // Failures on a context that was taken away are not the device's fault.
  const isTaken = () => isAsked && canvas.getContext('webgl2')?.isContextLost();
  try {
    /** @type {Renderer | Painter} */
    let renderer;
    if (kind === 'canvas2d') {
      const { Painter } = await import('./painter.js');
      renderer = await Painter.create(canvas);
    } else {
      const { default: init, Renderer: Made } = await bundle(kind);
      await init();
      isAsked = kind === 'webgl2';
      renderer = await Made.create(canvas, lost, (/** @type {string} */ message) => {
        queueMicrotask(() => {
          if (closed) return;
          if (isTaken()) events.onLost('taken away', message);
          else events.onError(message);
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
          // A trapped instance cannot be freed; removing the canvas releases its resources.
        }
        canvas.remove();
      },
    };
  } catch (error) {
    closed = true;
    canvas.remove();
    if (isTaken()) throw new DeviceLost(String(error));
    throw error;
  }
}
