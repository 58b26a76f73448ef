/**
 * Runs the worker that solves models from points, one order at a time. Keeps the results, so that a model is available
 * at once when it is chosen again.
 *
 * @module
 */
import { GRACE_MS, LOADING_MS, SILENCE_MS } from '../bundle/load.js';
import { RequestWorker } from '../bundle/requests.js';

/**
 * @import { Timer } from '../bundle/types.js'
 * @import { FromPoints, Order, PointsClientOptions, Refusal, Solved } from './types.js'
 */

/**
 * The end of an order. `givenUp`: the page cancelled it.
 * @typedef {{solved: Solved} | {refusal: Refusal} | {givenUp: true}} Ending
 */

export class PointsClient {
  #onProgress;
  #clock;

  /** @type {RequestWorker<Order, FromPoints>} */
  #worker;

  /** The number and the key of the current order. */
  #order = { id: 0, key: '' };

  /** @type {Timer | undefined} */
  #timer;

  /** @type {Map<string, Solved>} */
  #solved = new Map();

  /** @param {PointsClientOptions} options */
  constructor({
    spawn,
    onProgress,
    clock = { setTimeout: (f, ms) => setTimeout(f, ms), clearTimeout: (id) => clearTimeout(id) },
  }) {
    this.#onProgress = onProgress;
    this.#clock = clock;
    this.#worker = new RequestWorker({
      spawn,
      onMessage: (message) => this.#receive(message),
      onFail: (message) => this.#refuse('bundle', message || 'the solver did not load'),
    });
  }

  /** Returns the solved model for a key, if there is one. @param {string | undefined} key */
  get(key) {
    return key === undefined ? undefined : this.#solved.get(key);
  }

  /**
   * Solves a model and keeps it under `key`. The current order is cancelled.
   * @param {string} key @param {Order} order
   * @returns {Promise<Ending>}
   */
  load(key, order) {
    this.giveUp();
    return this.#worker.ask((id) => {
      this.#order = { id, key };
      this.#listen(LOADING_MS);
      return order;
    });
  }

  giveUp() {
    if (this.#worker.requests.count > 0) this.#end({ givenUp: true });
  }

  /** @param {FromPoints} message */
  #receive(message) {
    this.#listen(SILENCE_MS);
    switch (message.type) {
      case 'progress':
        this.#onProgress(message);
        break;
      case 'solved':
        this.#solved.set(this.#order.key, message.solved);
        this.#end({ solved: message.solved });
        break;
      case 'refused':
        this.#refuse(message.kind, message.message);
        break;
      case 'crashed':
        this.#refuse('crashed', 'the solver stopped on an error', `${message.message}\n${message.stack}`);
        break;
      case 'failed':
        this.#refuse('bundle', message.message);
        break;
      default:
    }
  }

  /** @param {string} kind @param {string} message @param {string} [details] */
  #refuse(kind, message, details = '') {
    this.#end({ refusal: { kind, message, details } });
  }

  /** Ends the order and its worker. @param {Ending} ending */
  #end(ending) {
    this.#clock.clearTimeout(this.#timer);
    this.#worker.requests.answer(this.#order.id, ending);
    this.#worker.end(new Error('the order has ended'));
  }

  /** Allows this much time for the next message before the worker counts as hung. @param {number} ms */
  #listen(ms) {
    const silent = () => this.#refuse('silent', 'the solver stopped answering and was ended');
    this.#clock.clearTimeout(this.#timer);
    this.#timer = this.#clock.setTimeout(() => {
      this.#timer = this.#clock.setTimeout(silent, GRACE_MS);
    }, ms);
  }
}
