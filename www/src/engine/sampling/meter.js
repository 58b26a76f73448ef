/**
 * Measures particles that the sampler has not placed, as the sampler's report would, in a worker that samples nothing
 * and ends after the last answer.
 *
 * ```js
 * const meter = new Meter();
 * const { quality, places } = await meter.measure({ formula, declare, bounds }, { positions, normals, radii }, false);
 * ```
 *
 * @module
 */
import { RequestWorker } from '../bundle/requests.js';
import { spawnSampler } from './spawn.js';

/**
 * @import { FieldRequest, SurfaceInfo } from '../types.js'
 * @import { FromWorker, PlacedColumns, PlacedMeasures, ToWorker, WorkerLike } from './types.js'
 */

export class Meter {
  /** @type {RequestWorker<ToWorker, FromWorker>} */
  #worker;

  /**
   * The surfaces of the gallery, which a worker sends first.
   * @type {SurfaceInfo[] | null}
   */
  #surfaces = null;

  /** Pending requests for the surfaces. @type {number[]} */
  #asked = [];

  /** @param {{ spawn?: () => WorkerLike }} [options] */
  constructor({ spawn = spawnSampler } = {}) {
    this.#worker = new RequestWorker({
      spawn,
      onMessage: (message) => this.#receive(message),
      onFail: (message) => this.#worker.end(new Error(message || 'the sampler did not load')),
    });
  }

  /** The surfaces of the gallery. @returns {Promise<SurfaceInfo[]>} */
  async surfaces() {
    if (this.#surfaces) return this.#surfaces;
    return this.#worker.requests.make((request) => {
      this.#asked.push(request);
      this.#worker.start();
    });
  }

  /**
   * Measures particles on a surface within the sampled box.
   * @param {Partial<FieldRequest>} field @param {PlacedColumns} placed
   * @param {boolean} isAdaptive  whether their sizes differ
   * @returns {Promise<PlacedMeasures>}
   */
  measure(field, { positions, normals, radii }, isAdaptive) {
    const placed = { positions, normals, radii };
    return this.#worker.ask((request) => ({ type: 'measure', request, field, placed, isAdaptive }));
  }

  /** @param {FromWorker} message */
  #receive(message) {
    if (message.type === 'failed' || message.type === 'crashed') return this.#worker.end(new Error(message.message));
    const { requests } = this.#worker;
    if (message.type === 'ready') {
      this.#surfaces = message.description.surfaces;
      for (const request of this.#asked.splice(0)) requests.answer(request, this.#surfaces);
    } else if (message.type === 'measured') {
      if ('measures' in message) requests.answer(message.request, message.measures);
      else requests.refuse(message.request, new Error(message.error.message));
    } else return;
    if (requests.count === 0) this.#worker.end(new Error('all is measured'));
  }
}
