/**
 * A front whose particles follow its surface, in a worker of its own: for figures that ask for every step themselves.
 *
 * ```js
 * const front = new FlowingFront();
 * await front.go(field, settings);
 * const { columns, evaluations } = await front.go(field, settings, { follows: true });
 * ```
 *
 * @module
 */
import { spawnSampler } from './spawn.js';

/**
 * @import { FieldRequest, Settings } from '../types.js'
 * @import { ColumnsMessage, FromWorker, WorkerLike } from './types.js'
 */

export class FlowingFront {
  #worker;
  #last = 0;
  /** @type {ColumnsMessage | null} */
  #columns = null;

  /** @type {{ resolve: (step: FlowStep) => void, reject: (error: Error) => void } | null} */
  #waiting = null;

  /** @typedef {{ columns: ColumnsMessage, evaluations: number }} FlowStep  `evaluations`: of f since the front began */

  /** @param {{ spawn?: () => WorkerLike }} [options] */
  constructor({ spawn = spawnSampler } = {}) {
    /** @type {WorkerLike} */
    this.#worker = spawn();
    this.#worker.onmessage = ({ data }) => this.#receive(data);
    this.#worker.onerror = ({ message }) => this.#fail(message || 'the sampler did not load');
  }

  /**
   * Covers the surface of a field; `follows`: with the particles of the step before, where the surface has not gone too
   * far, and `isClosed`: without births and deaths. A step is asked for once the one before has come.
   * @param {Pick<FieldRequest, 'formula' | 'declare' | 'bounds'>} field @param {Settings} settings
   * @param {{ follows?: boolean, isClosed?: boolean }} [how]
   * @returns {Promise<FlowStep>}
   */
  go(field, settings, { follows = false, isClosed = false } = {}) {
    this.#last += 1;
    return new Promise((resolve, reject) => {
      this.#waiting = { resolve, reject };
      this.#worker.postMessage({
        type: 'job',
        job: {
          kind: 'live',
          id: this.#last,
          field: { surface: null, parameters: {}, pins: [], ...field },
          points: null,
          settings,
          following: follows ? [settings] : [],
          isClosed,
          askAbove: Infinity,
        },
      });
    });
  }

  /** Ends the worker. A step that is asked for is given up. */
  close() {
    this.#worker.terminate();
    this.#fail('the front was closed');
  }

  /** @param {FromWorker} message */
  #receive(message) {
    switch (message.type) {
      case 'columns':
        // A message without particles tells of those that are here.
        if (message.radii.length > 0) this.#columns = message;
        break;
      case 'done':
        if (message.outcome !== 'complete' || !this.#columns) return this.#fail(message.message || message.outcome);
        this.#waiting?.resolve({ columns: this.#columns, evaluations: message.progress?.evaluations ?? 0 });
        break;
      case 'field':
        if (!message.answer.ok) this.#fail(message.answer.error.message);
        break;
      case 'crashed':
      case 'failed':
        this.#fail(message.message);
        break;
      default:
    }
  }

  /** @param {string} message */
  #fail(message) {
    this.#waiting?.reject(new Error(message));
  }
}
