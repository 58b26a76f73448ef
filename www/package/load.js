/** Locates the core's modules in a browser: next to the script. @module */

const MODULES = {
  core: new URL('../src/wasm/core/core_bg.wasm', import.meta.url),
  points: new URL('../src/wasm/points/points_bg.wasm', import.meta.url),
};

/** @type {import('./protocol.js').Load} */
export const load = async (name) => MODULES[name];
