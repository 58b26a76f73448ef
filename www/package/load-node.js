/** Where the modules of the core lie in Node: beside the script. @module */
import { readFile } from 'node:fs/promises';

/** @type {import('./protocol.js').Load} */
export const load = (name) => readFile(new URL(`./${name}_bg.wasm`, import.meta.url));
