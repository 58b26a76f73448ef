/**
 * Communicates with the sampler's worker: sends jobs and requests, passes its messages on, and tells a new worker what
 * the page needs.
 *
 * @module
 */
import { Requests } from '../bundle/requests.js';
import { Supervisor } from './supervisor.js';

/**
 * @import { KeyedFile, Opened } from '../files/types.js'
 * @import { FileRequest, Language } from '../types.js'
 * @import { ClientEvents, Clock, FromWorker, ToWorker, WorkerLike } from './types.js'
 */

const lost = () => new Error('The sampler does not hold these particles any more.');

export class SamplingClient {
  #onMessage;
  #onLoadFailed;

  /**
   * Whether the page shows the curvature and a mesh, and the formula of the value it shows. New workers get them, too.
   */
  #wishes = { curvature: false, mesh: false, value: '' };
  /** Files that are being written. */
  #files = new Requests();
  /** Texts that are read as numbers or checked, programs that are written, and sections of an image. */
  #texts = new Requests();
  /** The file that is being opened, and the callback for its progress. */
  #opening = new Requests();
  /** @type {(label: string, fraction: number) => void} */
  #onOpening = () => {};
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

  /** Whether there is a worker; it may still be loading. */
  get isThere() {
    return this.supervisor.worker !== null;
  }

  /** Whether there is no worker and none is loading. */
  get isOff() {
    return ['failed', 'safe'].includes(this.supervisor.state);
  }

  start() {
    this.supervisor.start();
  }

  /** Starts a worker at the user's request, after several have failed. */
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
   * Requests the curvature or the mesh while it is shown. The curvature needs second derivatives and the mesh a
   * triangulation, so neither is sent otherwise.
   * @param {'curvature' | 'mesh'} what @param {boolean} on
   */
  wish(what, on) {
    if (on === this.#wishes[what]) return;
    this.#wishes[what] = on;
    this.post({ type: what, on });
  }

  /** Requests the value of a formula while it is shown; an empty text ends it. @param {string} text */
  wishValue(text) {
    if (text === this.#wishes.value) return;
    this.#wishes.value = text;
    this.post({ type: 'value', text });
  }

  /**
   * Returns the mesh of the particles that the worker holds, as a file.
   * @param {Partial<FileRequest>} file
   * @returns {Promise<Uint8Array<ArrayBuffer>>}
   * @throws if the worker does not hold the particles
   */
  meshFile(file) {
    const bytes = this.#files.make((request) => {
      if (this.isThere) this.post({ type: 'export', request, file });
      else this.#files.refuse(request, lost());
    });
    this.#attend();
    return bytes;
  }

  /**
   * Returns the number that a text without names stands for in the language of formulas, such as `pi/2`; null for any
   * other text, or without a worker.
   * @param {string} text
   * @returns {Promise<number | null>}
   */
  number(text) {
    if (!this.isThere) return Promise.resolve(null);
    return this.#texts.make((request) => this.post({ type: 'number', request, text })).catch(() => null);
  }

  /**
   * Returns a program that makes the particles of the last run.
   * @param {Language} language
   * @returns {Promise<string>}
   * @throws if there is none, with the reason
   */
  code(language) {
    return this.#texts.make((request) => {
      if (this.isThere) this.post({ type: 'code', request, language });
      else this.#texts.refuse(request, lost());
    });
  }

  /**
   * Returns what is wrong with the formula of a thickness or a spacing on the current surface; null if nothing is, or
   * without a worker.
   * @param {'thickness' | 'spacing'} what @param {string} text
   * @returns {Promise<string | null>}
   */
  textFault(what, text) {
    if (!this.isThere) return Promise.resolve(null);
    return this.#texts.make((request) => this.post({ type: 'fault', request, what, text })).catch(() => null);
  }

  /**
   * Returns the voxels of the image in a rectangle: NaN outside it; null without an image.
   * @param {number[]} place  a corner and the steps along two directions @param {[number, number]} size  points
   * @returns {Promise<Float32Array | null>}
   */
  section(place, size) {
    if (!this.isThere) return Promise.resolve(null);
    return this.#texts.make((request) => this.post({ type: 'section', request, place, size })).catch(() => null);
  }

  /**
   * Opens the file of an image or a mesh in the worker. Resolves with null if it is cancelled or the worker is gone.
   * @param {KeyedFile} file @param {(label: string, fraction: number) => void} onProgress
   * @returns {Promise<Opened>}
   */
  openFile(file, onProgress) {
    if (!this.isThere) return Promise.resolve({ ok: false, kind: file.as, message: 'the sampler is not running' });
    this.#onOpening = onProgress;
    return this.#opening.make((request) => this.post({ type: 'open', request, file })).catch(() => null);
  }

  /** Cancels the opening of a file: immediately here, and in the worker as soon as it reads messages. */
  stopOpening() {
    if (this.#opening.count === 0) return;
    this.post({ type: 'open_stop' });
    this.#opening.refuseAll(lost());
  }

  /** Cancels all files and texts, because the worker is gone. */
  forgetFiles() {
    this.#texts.refuseAll(lost());
    this.#opening.refuseAll(lost());
    this.#files.refuseAll(lost());
    this.#attend();
  }

  /** Sets whether the worker has a run or a report to make. @param {boolean} isBusy */
  setBusy(isBusy) {
    this.#isBusy = isBusy;
    this.#attend();
  }

  /** A silent worker is replaced only if it has work. */
  #attend() {
    this.supervisor.setBusy(this.#isBusy || this.#files.count > 0);
  }

  /** @param {FromWorker} message */
  #receive(message) {
    switch (message.type) {
      case 'ready':
        this.#attend();
        for (const what of /** @type {const} */ (['curvature', 'mesh']))
          if (this.#wishes[what]) this.post({ type: what, on: true });
        if (this.#wishes.value) this.post({ type: 'value', text: this.#wishes.value });
        return this.#onMessage(message);
      case 'failed':
        return this.#onLoadFailed(message.message);
      case 'beat':
      case 'opening':
      case 'crashed':
        return;
      case 'number':
        return this.#texts.answer(message.request, message.value);
      case 'code':
        if (message.answer.ok) this.#texts.answer(message.request, message.answer.text);
        else this.#texts.refuse(message.request, new Error(message.answer.error));
        return;
      case 'fault':
        return this.#texts.answer(message.request, message.fault);
      case 'section':
        return this.#texts.answer(message.request, message.values);
      case 'open_progress':
        return this.#onOpening(message.label, message.fraction);
      case 'opened':
        return this.#opening.answer(message.request, message.opened);
      case 'file':
        if (message.bytes) this.#files.answer(message.request, message.bytes);
        else this.#files.refuse(message.request, lost());
        return this.#attend();
      default:
        this.#onMessage(message);
    }
  }
}
