/**
 * The package in one file that contains the modules of the core, for pages that load it from another host or may not
 * start workers. Everything is sampled in the importing thread, in slices.
 *
 * @module
 */
import core from '../src/wasm/core/core_bg.wasm';
import points from '../src/wasm/points/points_bg.wasm';
import { createSampler } from './client.js';
import { openHere } from './here.js';

export { DisposedError, FieldError, FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';
export { difference, intersection, offset, smoothUnion, union } from './solids.js';

const open = openHere(async (name) => ({ core, points })[name]);
export const sample = createSampler(open, open);
