/**
 * Runs the worker that solves models from points, one order at a time. It keeps the results, so that a model chosen
 * again is available at once.
 *
 * @module
 */

import { GRACE_MS, LOADING_MS, SILENCE_MS } from '../bundle/load.js';

/**
 * @import { Timer } from '../bundle/types.js'
 * @import { Order, PointsClientOptions, Refusal, Solved } from './types.js'
 */

/**
 * The end of an order. `givenUp`: the page cancelled it.
 * @typedef {{solved: Solved} | {refusal: Refusal} | {givenUp: true}} Ending
 */

export class PointsClient {
  #spawn;
  #onProgress;
  #clock;

  /** @type {Map<string, Solved>} */
  #solved;

  /** Ends the current order. @type {((ending: Ending) => void) | null} */
  #end;

  /** @param {PointsClientOptions} options */
  constructor({
    spawn,
    onProgress,
    clock = { setTimeout: (f, ms) => setTimeout(f, ms), clearTimeout: (id) => clearTimeout(id) },
  }) {
    this.#spawn = spawn;
    this.#onProgress = onProgress;
    this.#clock = clock;
    this.#solved = new Map();
    this.#end = null;
  }

  /** Returns the solved model under this key, if there is one. @param {string | undefined} key */
  get(key) {
    return key === undefined ? undefined : this.#solved.get(key);
  }

  /**
   * Solves a model and keeps it under `key`. The current order is given up.
   * @param {string} key @param {Order} order
   * @returns {Promise<Ending>}
   */
  load(key, order) {
    this.giveUp();
    return new Promise((resolve) => {
      const worker = this.#spawn();
      /** @type {Timer | undefined} */
      let timer;
      const end = (/** @type {Ending} */ ending) => {
        this.#clock.clearTimeout(timer);
        worker.onmessage = null;
        worker.onerror = null;
        worker.terminate();
        if (this.#end === end) this.#end = null;
        if ('solved' in ending) this.#solved.set(key, ending.solved);
        resolve(ending);
      };
      const refuse = (/** @type {string} */ kind, /** @type {string} */ message, /** @type {string} */ details = '') =>
        end({ refusal: { kind, message, details } });
      const silent = () => refuse('silent', 'the solver fell silent and was stopped');
      const listen = (/** @type {number} */ ms) => {
        this.#clock.clearTimeout(timer);
        timer = this.#clock.setTimeout(() => {
          timer = this.#clock.setTimeout(silent, GRACE_MS);
        }, ms);
      };
      worker.onmessage = ({ data }) => {
        listen(SILENCE_MS);
        switch (data.type) {
          case 'progress':
            this.#onProgress(data);
            break;
          case 'solved':
            end({ solved: data.solved });
            break;
          case 'refused':
            refuse(data.kind, data.message);
            break;
          case 'crashed':
            refuse('crashed', 'the solver stopped on an error', `${data.message}\n${data.stack}`);
            break;
          case 'failed':
            refuse('bundle', data.message);
            break;
          default:
        }
      };
      worker.onerror = (event) => refuse('bundle', event.message || 'the solver did not load');
      this.#end = end;
      listen(LOADING_MS);
      worker.postMessage(order);
    });
  }

  giveUp() {
    this.#end?.({ givenUp: true });
  }
}
