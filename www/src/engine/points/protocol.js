/**
 * What the page and the worker that turns points into a field say to each other. A worker lives for one model or file: its
 * memory, which a large file has filled, goes with it, and giving up is to end it.
 *
 * @module
 */

/**
 * @typedef {import('../types.js').ModelInfo} ModelInfo
 * @typedef {import('../types.js').Bounds} Bounds
 * @typedef {import('../types.js').Loading} Loading
 */

/** A built-in model by its id, or a file. @typedef {{model: string} | {file: File}} Order */
/**
 * A solved model: `field` is for the core, which reads it together with `info`; `centres` are three numbers each.
 * @typedef {{field: Uint8Array, info: {info: ModelInfo, bounds: Bounds}, centres: Float32Array}} Solved
 */
/**
 * @typedef {{type: 'progress', stage: Loading['stage'], label: string, fraction: number}
 *   | {type: 'solved', solved: Solved}
 *   | {type: 'refused', kind: string, message: string, line: number | null}
 *   | {type: 'crashed', message: string, stack: string}
 *   | {type: 'failed', message: string}} FromPoints  `failed`: the bundle did not load
 */

export {};
