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
import { RequestWorker } from '../bundle/requests.js';
import { spawnSampler } from './spawn.js';

/**
 * @import { FieldRequest, Settings } from '../types.js'
 * @import { ColumnsMessage, FromWorker, ToWorker, WorkerLike } from './types.js'
 */

/** @typedef {{ columns: ColumnsMessage, evaluations: number }} FlowStep  `evaluations`: of f since the front began */

export class FlowingFront {
  /** @type {RequestWorker<ToWorker, FromWorker>} */
  #worker;
  /** @type {ColumnsMessage | null} */
  #columns = null;

  /** @param {{ spawn?: () => WorkerLike }} [options] */
  constructor({ spawn = spawnSampler } = {}) {
    this.#worker = new RequestWorker({
      spawn,
      onMessage: (message) => this.#receive(message),
      onFail: (message) => this.#worker.end(new Error(message || 'the sampler did not load')),
    });
  }

  /**
   * Covers the surface of a field; `follows`: with the particles of the step before, where the surface has not gone too
   * far, and `isClosed`: without births and deaths. A step is asked for once the one before has come.
   * @param {Pick<FieldRequest, 'formula' | 'declare' | 'bounds'>} field @param {Settings} settings
   * @param {{ follows?: boolean, isClosed?: boolean }} [how]
   * @returns {Promise<FlowStep>}
   */
  go(field, settings, { follows = false, isClosed = false } = {}) {
    return this.#worker.ask((id) => ({
      type: 'job',
      job: {
        kind: 'live',
        id,
        field: { surface: null, parameters: {}, pins: [], ...field },
        points: null,
        settings,
        following: follows ? [settings] : [],
        isClosed,
        askAbove: Infinity,
      },
    }));
  }

  /** Ends the worker. A step that is asked for is given up. */
  close() {
    this.#worker.end(new Error('the front was closed'));
  }

  /** @param {FromWorker} message */
  #receive(message) {
    const { requests } = this.#worker;
    switch (message.type) {
      case 'columns':
        // A message without particles tells of those that are here.
        if (message.radii.length > 0) this.#columns = message;
        break;
      case 'done':
        if (message.outcome !== 'complete' || !this.#columns) {
          requests.refuse(message.id, new Error(message.message || message.outcome));
        } else {
          requests.answer(message.id, { columns: this.#columns, evaluations: message.progress?.evaluations ?? 0 });
        }
        break;
      case 'field':
        if (!message.answer.ok) requests.refuse(message.id, new Error(message.answer.error.message));
        break;
      case 'crashed':
      case 'failed':
        this.#worker.end(new Error(message.message));
        break;
      default:
    }
  }
}
