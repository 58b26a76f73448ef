/**
 * Talks with the sampler's worker: sends it jobs and wishes, hands its messages on, and repeats to a new worker what
 * the page wants.
 *
 * @module
 */
import { Supervisor } from './supervisor.js';

/**
 * @import { FileRequest } from '../types.js'
 * @import { ClientEvents, Clock, FromWorker, ToWorker, WorkerLike } from './types.js'
 */

export class SamplingClient {
  #onMessage;
  #onLoadFailed;

  /** Whether the page shows the curvature and a mesh. A new worker is told again. */
  #wishes = { curvature: false, mesh: false };
  /**
   * The pending requests for a file, by their numbers.
   * @type {Map<number, (bytes: Uint8Array<ArrayBuffer> | null) => void>}
   */
  #files = new Map();
  #lastFile = 0;
  /**
   * The texts that are being read as numbers, by the numbers of their requests.
   * @type {Map<number, (value: number | null) => void>}
   */
  #texts = new Map();
  #isBusy = false;

  /** @param {ClientEvents & {spawn: () => WorkerLike, clock?: Clock}} options */
  constructor({ spawn, clock, onMessage, onRestart, onSafeMode, onLoadFailed }) {
    this.#onMessage = onMessage;
    this.#onLoadFailed = onLoadFailed;
    this.supervisor = new Supervisor({
      spawn,
      clock,
      onMessage: (message) => this.#receive(message),
      onRestart,
      onSafeMode,
      onLoadError: (message) => onLoadFailed(`The sampler did not load: ${message}.`),
    });
  }

  /** Whether there is a worker, which may still be loading. */
  get isThere() {
    return this.supervisor.worker !== null;
  }

  /** Whether there is no worker, and none is loading. */
  get isOff() {
    return ['failed', 'safe'].includes(this.supervisor.state);
  }

  start() {
    this.supervisor.start();
  }

  /** Starts a worker at the user's request, after too many have failed. */
  revive() {
    this.supervisor.revive();
  }

  close() {
    this.supervisor.stop();
  }

  /** @param {ToWorker} message */
  post(message) {
    this.supervisor.post(message);
  }

  /**
   * Asks for the curvature or for the mesh while it is shown. The curvature costs second derivatives and the mesh a
   * triangulation, so neither is sent otherwise.
   * @param {'curvature' | 'mesh'} what @param {boolean} on
   */
  wish(what, on) {
    if (on === this.#wishes[what]) return;
    this.#wishes[what] = on;
    this.post({ type: what, on });
  }

  /**
   * Returns the mesh of the particles that the worker holds, as a file.
   * @param {Partial<FileRequest>} file
   * @returns {Promise<Uint8Array<ArrayBuffer>>}
   * @throws if the worker does not hold the particles
   */
  async meshFile(file) {
    this.#lastFile += 1;
    const request = this.#lastFile;
    const bytes = await new Promise((resolve) => {
      this.#files.set(request, resolve);
      if (this.isThere) this.post({ type: 'export', request, file });
      else this.#handOver(request, null);
      this.#attend();
    });
    if (!bytes) throw new Error('The sampler does not hold these particles any more.');
    return bytes;
  }

  /**
   * Returns the number that a text without names stands for in the language of formulas, such as `pi/2`; null for any
   * other text, and without a worker.
   * @param {string} text
   * @returns {Promise<number | null>}
   */
  number(text) {
    if (!this.isThere) return Promise.resolve(null);
    this.#lastFile += 1;
    const request = this.#lastFile;
    return new Promise((resolve) => {
      this.#texts.set(request, resolve);
      this.post({ type: 'number', request, text });
    });
  }

  /** Gives up all files and texts, because the worker is gone. */
  forgetFiles() {
    for (const resolve of this.#texts.values()) resolve(null);
    this.#texts.clear();
    for (const request of [...this.#files.keys()]) this.#handOver(request, null);
  }

  /** @param {number} request @param {Uint8Array<ArrayBuffer> | null} bytes */
  #handOver(request, bytes) {
    this.#files.get(request)?.(bytes);
    this.#files.delete(request);
    this.#attend();
  }

  /** Says whether the worker has a run or a report to make. @param {boolean} isBusy */
  setBusy(isBusy) {
    this.#isBusy = isBusy;
    this.#attend();
  }

  /** A silent worker is replaced only while it has work. */
  #attend() {
    this.supervisor.setBusy(this.#isBusy || this.#files.size > 0);
  }

  /** @param {FromWorker} message */
  #receive(message) {
    switch (message.type) {
      case 'ready':
        this.#attend();
        for (const what of /** @type {const} */ (['curvature', 'mesh']))
          if (this.#wishes[what]) this.post({ type: what, on: true });
        return this.#onMessage(message);
      case 'failed':
        return this.#onLoadFailed(message.message);
      case 'beat':
      case 'crashed':
        return;
      case 'number':
        this.#texts.get(message.request)?.(message.value);
        this.#texts.delete(message.request);
        return;
      case 'file':
        return this.#handOver(message.request, message.bytes);
      default:
        this.#onMessage(message);
    }
  }
}
