/**
 * Measures particles that the sampler has not placed by the meter of its reports, in a worker that samples nothing and
 * ends with the last answer.
 *
 * ```js
 * const meter = new Meter();
 * const { quality, places } = await meter.measure({ formula, declare, bounds }, { positions, normals, radii }, false);
 * ```
 *
 * @module
 */
import { spawnSampler } from './spawn.js';

/**
 * @import { FieldRequest } from '../types.js'
 * @import { FromWorker, PlacedColumns, PlacedMeasures, WorkerLike } from './types.js'
 */

/** @typedef {{resolve: (measures: PlacedMeasures) => void, reject: (error: Error) => void}} Waiting */

export class Meter {
  #spawn;

  /** @type {WorkerLike | null} */
  #worker = null;
  #last = 0;

  /** The open questions, by their numbers. @type {Map<number, Waiting>} */
  #waiting = new Map();

  /** @param {{ spawn?: () => WorkerLike }} [options] */
  constructor({ spawn = spawnSampler } = {}) {
    this.#spawn = spawn;
  }

  /**
   * Measures particles on a surface, in the box that is sampled.
   * @param {Partial<FieldRequest>} field @param {PlacedColumns} placed
   * @param {boolean} isAdaptive  whether they differ in size
   * @returns {Promise<PlacedMeasures>}
   */
  measure(field, { positions, normals, radii }, isAdaptive) {
    this.#last += 1;
    const request = this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(request, { resolve, reject });
      this.#worker ??= this.#listen(this.#spawn());
      this.#worker.postMessage({ type: 'measure', request, field, placed: { positions, normals, radii }, isAdaptive });
    });
  }

  /** @param {WorkerLike} worker */
  #listen(worker) {
    worker.onmessage = ({ data }) => this.#receive(data);
    worker.onerror = (event) => this.#fail(event.message || 'the sampler did not load');
    return worker;
  }

  /** @param {FromWorker} message */
  #receive(message) {
    if (message.type === 'failed' || message.type === 'crashed') return this.#fail(message.message);
    if (message.type !== 'measured') return;
    const waiting = this.#waiting.get(message.request);
    this.#waiting.delete(message.request);
    if ('measures' in message) waiting?.resolve(message.measures);
    else waiting?.reject(new Error(message.error.message));
    if (this.#waiting.size === 0) this.#end();
  }

  #end() {
    this.#worker?.terminate();
    this.#worker = null;
  }

  /** @param {string} message */
  #fail(message) {
    this.#end();
    for (const { reject } of this.#waiting.values()) reject(new Error(message));
    this.#waiting.clear();
  }
}
