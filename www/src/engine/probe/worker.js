/**
 * Finds out who draws WebGL2. This takes a worker: a graphics process that is busy keeps who asks for a context waiting
 * for seconds.
 */
import { isProgram } from './names.js';

/** @import { Drawer } from './types.js' */

/** @returns {Drawer} */
function drawer() {
  // Without these a worker has no WebGL2 and the page may have it.
  if (!globalThis.OffscreenCanvas || !globalThis.WebGL2RenderingContext) return null;
  // A browser that knows its renderer to be slow gives no context on this condition.
  const fast = new OffscreenCanvas(1, 1).getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  const context = fast ?? new OffscreenCanvas(1, 1).getContext('webgl2');
  if (!context) return 'none';
  const named = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return fast && !isProgram(name) ? 'card' : 'software';
}

postMessage(drawer());
