/**
 * Requests to a worker and their answers, matched by number.
 *
 * @module
 */

/** @import { RequestWorkerOptions, WorkerLike } from './types.js' */

export class Requests {
  #last = 0;

  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  #open = new Map();

  /** Number of requests without an answer. */
  get count() {
    return this.#open.size;
  }

  /**
   * Makes a request with a new number. Resolves with the answer.
   * @param {(id: number) => void} send
   * @returns {Promise<any>}
   */
  make(send) {
    this.#last += 1;
    const id = this.#last;
    return new Promise((resolve, reject) => {
      this.#open.set(id, { resolve, reject });
      send(id);
    });
  }

  /** @param {number} id @param {unknown} value */
  answer(id, value) {
    this.#take(id)?.resolve(value);
  }

  /** @param {number} id @param {Error} error */
  refuse(id, error) {
    this.#take(id)?.reject(error);
  }

  /** @param {Error} error */
  refuseAll(error) {
    const open = [...this.#open.values()];
    this.#open.clear();
    for (const { reject } of open) reject(error);
  }

  /** @param {number} id */
  #take(id) {
    const request = this.#open.get(id);
    this.#open.delete(id);
    return request;
  }
}

/**
 * A worker for requests. The first request starts it; after its end the next one starts another.
 * @template Sent
 * @template Heard
 */
export class RequestWorker {
  #options;
  /** @type {WorkerLike<Sent, Heard> | null} */
  #worker = null;
  requests = new Requests();

  /** @param {RequestWorkerOptions<Sent, Heard>} options */
  constructor(options) {
    this.#options = options;
  }

  /** @param {(id: number) => Sent} message @returns {Promise<any>} */
  ask(message) {
    return this.requests.make((id) => this.start().postMessage(message(id)));
  }

  /** Starts a worker if there is none. */
  start() {
    this.#worker ??= this.#start();
    return this.#worker;
  }

  /** @param {Sent} message  dropped while there is no worker */
  post(message) {
    this.#worker?.postMessage(message);
  }

  /** Ends the worker, which frees its memory, and rejects open requests. @param {Error} error */
  end(error) {
    if (this.#worker) {
      this.#worker.onmessage = null;
      this.#worker.onerror = null;
      this.#worker.terminate();
      this.#worker = null;
    }
    this.requests.refuseAll(error);
  }

  #start() {
    const { spawn, onMessage, onFail } = this.#options;
    const worker = spawn();
    worker.onmessage = ({ data }) => onMessage(data);
    worker.onerror = ({ message }) => onFail(message ?? '');
    return worker;
  }
}
