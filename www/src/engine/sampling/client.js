/**
 * The page's side of the sampler's worker: starts it, sends it jobs and requests, passes its messages on, and replaces
 * it after a trap or a long silence during work. The page's state lives outside the worker, so only the current run is
 * lost. A new worker is told what the page needs.
 *
 * After more than three replacements in a minute it enters safe mode: no worker runs until the user asks for one.
 *
 * @module
 */
import { GRACE_MS, LOADING_MS, SILENCE_MS } from '../bundle/load.js';
import { Requests } from '../bundle/requests.js';

/**
 * @import { Timer } from '../bundle/types.js'
 * @import { KeyedFile, Opened } from '../files/types.js'
 * @import { FileRequest, Language, MeshFaces } from '../types.js'
 * @import { ClientOptions, Clock, Crash, FromWorker, ToWorker, WorkerLike } from './types.js'
 */

/** Time window in which replacements are counted. */
const WINDOW_MS = 60_000;
/** Largest number of replacements in the window. One more starts safe mode. */
const RESTARTS = 3;

/** @type {Clock} */
const BROWSER_CLOCK = {
  now: () => performance.now(),
  setTimeout: (f, ms) => setTimeout(f, ms),
  clearTimeout: (id) => clearTimeout(id),
};

const lost = () => new Error('The sampler does not hold these particles any more.');

export class SamplingClient {
  #spawn;
  #onMessage;
  #onRestart;
  #onSafeMode;
  #onLoadFailed;
  #clock;
  /** @type {WorkerLike | null} */
  #worker = null;
  /** @type {'off' | 'loading' | 'up' | 'failed' | 'safe'} */
  #state = 'off';
  /** Whether the worker has a run or a report to make. */
  #isBusy = false;
  /** Until this time the worker may be silent. */
  #deadline = 0;
  /** @type {Timer | undefined} */
  #timer;
  /** When workers were replaced. @type {number[]} */
  restarts = [];

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

  /** @param {ClientOptions} options */
  constructor({ spawn, onMessage, onRestart, onSafeMode, onLoadFailed, clock = BROWSER_CLOCK }) {
    this.#spawn = spawn;
    this.#onMessage = onMessage;
    this.#onRestart = onRestart;
    this.#onSafeMode = onSafeMode;
    this.#onLoadFailed = onLoadFailed;
    this.#clock = clock;
  }

  /** Whether there is a worker; it may still be loading. */
  get isThere() {
    return this.#worker !== null;
  }

  /** Whether there is no worker and none is loading. */
  get isOff() {
    return ['failed', 'safe'].includes(this.#state);
  }

  // ---- requests
  // -------------------------------------------------------------------------------------------------------

  /** @param {ToWorker} message  dropped while there is no worker */
  post(message) {
    this.#worker?.postMessage(message);
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
    this.#watch();
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

  /** Returns the mesh of the open file; null if there is none. @returns {Promise<MeshFaces | null>} */
  meshFaces() {
    if (!this.isThere) return Promise.resolve(null);
    return this.#texts.make((request) => this.post({ type: 'faces', request })).catch(() => null);
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
    this.#watch();
  }

  // ---- the life of the worker
  // -----------------------------------------------------------------------------------------

  start() {
    if (this.#worker) return;
    const worker = this.#spawn();
    this.#worker = worker;
    this.#state = 'loading';
    this.#watch();
    worker.onmessage = ({ data }) => {
      // Late messages of a terminated worker are ignored.
      if (this.#worker === worker) this.receive(data);
    };
    worker.onerror = (event) => {
      if (this.#worker !== worker) return;
      if (this.#state === 'loading') this.#fail(event.message || 'its script did not load');
      else this.#replace('panic', event.message || 'uncaught error', '');
    };
  }

  /** Leaves safe mode at the user's request and starts a worker. */
  revive() {
    if (this.#worker) return;
    this.restarts = [];
    this.start();
  }

  /** Sets whether the worker has a run or a report to make. @param {boolean} isBusy */
  setBusy(isBusy) {
    this.#isBusy = isBusy;
    this.#watch();
  }

  /** @param {FromWorker} message */
  receive(message) {
    if (message.type === 'ready') {
      this.#state = 'up';
      // The timer still waits for the end of loading, which would be later than the end of the next silence.
      this.#rest();
    }
    this.#heard();
    // The core mends a mesh in one go, which takes seconds if the mesh is large.
    if (message.type === 'opening' || message.type === 'open_progress') this.#deadline = this.#clock.now() + LOADING_MS;
    if (message.type === 'failed') {
      this.#drop();
      this.#state = 'failed';
    }
    if (message.type === 'crashed') return this.#replace('panic', message.message, message.stack);
    this.#watch();
    this.#answer(message);
  }

  /** How long the worker may be silent. No input can hang it while it loads, but a browser may compile for long. */
  get #patience() {
    return this.#state === 'loading' ? LOADING_MS : SILENCE_MS;
  }

  #heard() {
    this.#deadline = this.#clock.now() + this.#patience;
  }

  /** Monitors the worker's silence while it loads or has work. */
  #watch() {
    const works = this.#isBusy || this.#files.count > 0 || this.#state === 'loading';
    if (!this.#worker || !works) {
      this.#rest();
    } else if (this.#timer === undefined) {
      this.#heard();
      this.#wait();
    }
  }

  #wait() {
    this.#timer = this.#clock.setTimeout(() => this.#check(false), Math.max(1, this.#deadline - this.#clock.now()));
  }

  /** @param {boolean} again */
  #check(again) {
    this.#timer = undefined;
    if (this.#clock.now() < this.#deadline) this.#wait();
    else if (!again) this.#timer = this.#clock.setTimeout(() => this.#check(true), GRACE_MS);
    else if (this.#state === 'loading') this.#fail(`no word from it for ${LOADING_MS / 1000} s`);
    else this.#replace('hang', `no word from the sampler for ${SILENCE_MS / 1000} s`, '');
  }

  /** Gives up on a worker that did not load. @param {string} message */
  #fail(message) {
    this.#drop();
    this.#state = 'failed';
    this.#onLoadFailed(`The sampler did not load: ${message}.`);
  }

  #rest() {
    this.#clock.clearTimeout(this.#timer);
    this.#timer = undefined;
  }

  #drop() {
    this.#rest();
    const worker = this.#worker;
    this.#worker = null;
    if (worker) {
      worker.onmessage = null;
      worker.onerror = null;
      worker.terminate();
    }
    this.#isBusy = false;
  }

  /** @param {Crash['cause']} cause @param {string} message @param {string} stack */
  #replace(cause, message, stack) {
    this.#drop();
    const now = this.#clock.now();
    this.restarts = [...this.restarts.filter((t) => now - t < WINDOW_MS), now];
    const crash = { cause, message, stack, restarts: this.restarts.length };
    if (this.restarts.length > RESTARTS) {
      this.#state = 'safe';
      this.#onSafeMode(crash);
    } else {
      this.start();
      this.#onRestart(crash);
    }
  }

  close() {
    this.#drop();
    this.#state = 'off';
  }

  /** @param {FromWorker} message */
  #answer(message) {
    switch (message.type) {
      case 'ready':
        for (const what of /** @type {const} */ (['curvature', 'mesh']))
          if (this.#wishes[what]) this.post({ type: what, on: true });
        if (this.#wishes.value) this.post({ type: 'value', text: this.#wishes.value });
        return this.#onMessage(message);
      case 'failed':
        return this.#onLoadFailed(message.message);
      case 'beat':
      case 'opening':
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
      case 'faces':
        return this.#texts.answer(message.request, message.mesh);
      case 'open_progress':
        return this.#onOpening(message.label, message.fraction);
      case 'opened':
        return this.#opening.answer(message.request, message.opened);
      case 'file':
        if (message.bytes) this.#files.answer(message.request, message.bytes);
        else this.#files.refuse(message.request, lost());
        return this.#watch();
      default:
        this.#onMessage(message);
    }
  }
}
