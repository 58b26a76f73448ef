/** Where the modules of the core lie in a browser: beside the script. @module */

/** @type {import('./protocol.js').Load} */
export const load = async (name) =>
  name === 'core' ? new URL('./core_bg.wasm', import.meta.url) : new URL('./points_bg.wasm', import.meta.url);
