/** Locates the core's modules in Node: next to the script. @module */
import { readFile } from 'node:fs/promises';

const MODULES = {
  core: new URL('../src/wasm/core/core_bg.wasm', import.meta.url),
  points: new URL('../src/wasm/points/points_bg.wasm', import.meta.url),
};

/** @type {import('./protocol.js').Load} */
export const load = (name) => readFile(MODULES[name]);
