/**
 * Finds out what draws WebGL2 on a canvas.
 *
 * @module
 */
import { isProgram } from './names.js';

/** @import { Drawer } from './types.js' */

/** @param {() => OffscreenCanvas | HTMLCanvasElement} create  a canvas @returns {Drawer} */
export function drawerOn(create) {
  const open = (/** @type {WebGLContextAttributes} */ how) =>
    /** @type {WebGL2RenderingContext | null} */ (create().getContext('webgl2', how));
  // With this condition a browser returns no context if it knows that its renderer is slow.
  const fast = open({ failIfMajorPerformanceCaveat: true });
  const context = fast ?? open({});
  if (!context) return 'none';
  const named = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return fast && !isProgram(name) ? 'card' : 'software';
}
