/**
 * Messages between the page and the worker that turns points into a field. A worker handles one model or file and is
 * then terminated, which releases the memory that a large file takes. Termination is also how an order is cancelled.
 *
 * @module
 */

/** @import { Bounds, Loading, ModelInfo } from '../types.js' */

/**
 * A request for a built-in model, by its id, or for a file, of whose points so many are to be fitted; null for the
 * default number.
 * @typedef {({model: string} | {file: File}) & {centres: number | null}} Order
 */
/**
 * A solved model. The core reads `field` together with `info`; `centres` has three coordinates per centre.
 * @typedef {{field: Uint8Array, info: {info: ModelInfo, bounds: Bounds}, centres: Float32Array}} Solved
 */
/**
 * @typedef {{type: 'progress', stage: Loading['stage'], label: string, fraction: number}
 *   | {type: 'beat'}
 *   | {type: 'solved', solved: Solved}
 *   | {type: 'refused', kind: string, message: string, line: number | null}
 *   | {type: 'crashed', message: string, stack: string}
 *   | {type: 'failed', message: string}} FromPoints  `failed`: the bundle did not load
 */

/** Largest interval between messages while the worker loads or reads. */
export const BEAT_MS = 250;
