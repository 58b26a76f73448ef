/**
 * Finds out what draws WebGL2. It runs in a worker, because a busy graphics process can block a request for a context
 * for seconds.
 */
import { drawerOn } from './drawer.js';

postMessage(globalThis.OffscreenCanvas ? drawerOn(() => new OffscreenCanvas(1, 1)) : 'none');
