/**
 * Finds out who draws WebGL2. This takes a worker: a graphics process that is busy keeps who asks for a context waiting
 * for seconds.
 */
import { drawerOn } from './drawer.js';

postMessage(globalThis.OffscreenCanvas ? drawerOn(() => new OffscreenCanvas(1, 1)) : 'none');
