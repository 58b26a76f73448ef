/**
 * Supervises the sampler's worker: starts it, receives its messages, and replaces it after a trap or a long silence
 * during work. The page's state lives outside the worker, so only the current run is lost.
 *
 * After more than three replacements in a minute it enters safe mode: no worker runs until the user asks for one.
 *
 * @module
 */
import { GRACE_MS, LOADING_MS, SILENCE_MS } from '../bundle/load.js';

/**
 * @import { Timer } from '../bundle/types.js'
 * @import { Clock, Crash, FromWorker, SupervisorOptions, ToWorker, WorkerLike } from './types.js'
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

export class Supervisor {
  #spawn;
  #onMessage;
  #onRestart;
  #onSafeMode;
  #onLoadError;
  #clock;
  #busy;

  /** Until this time the worker may be silent. */
  #deadline;

  /** @type {Timer | undefined} */
  #timer;

  /** @param {SupervisorOptions} options */
  constructor({ spawn, onMessage, onRestart, onSafeMode, onLoadError, clock = BROWSER_CLOCK }) {
    this.#spawn = spawn;
    this.#onMessage = onMessage;
    this.#onRestart = onRestart;
    this.#onSafeMode = onSafeMode;
    this.#onLoadError = onLoadError;
    this.#clock = clock;
    /** @type {WorkerLike | null} */
    this.worker = null;
    /** @type {'off' | 'loading' | 'up' | 'failed' | 'safe'} */
    this.state = 'off';
    this.#busy = false;
    this.#deadline = 0;
    this.#timer = undefined;
    /** @type {number[]} */
    this.restarts = [];
  }

  start() {
    if (this.worker) return;
    const worker = this.#spawn();
    this.worker = worker;
    this.state = 'loading';
    this.#busy = false;
    this.#heard();
    this.#watch();
    worker.onmessage = ({ data }) => {
      // Late messages of a terminated worker are ignored.
      if (this.worker === worker) this.receive(data);
    };
    worker.onerror = (event) => {
      if (this.worker !== worker) return;
      if (this.state === 'loading') {
        this.#fail(event.message || 'its script did not load');
      } else {
        this.#replace('panic', event.message || 'uncaught error', '');
      }
    };
  }

  /** Leaves safe mode at the user's request and starts a worker. */
  revive() {
    if (this.worker) return;
    this.restarts = [];
    this.start();
  }

  /** @param {ToWorker} message  dropped while there is no worker */
  post(message) {
    this.worker?.postMessage(message);
  }

  /** Sets whether the worker has work. Silence is only monitored while it has. @param {boolean} busy */
  setBusy(busy) {
    if (busy && !this.#busy && this.state === 'up') this.#heard();
    this.#busy = busy;
    this.#watch();
  }

  /** @param {FromWorker} message */
  receive(message) {
    if (message.type === 'ready') {
      this.state = 'up';
      // The timer still waits for the end of loading, which would be later than the end of the next silence.
      this.#rest();
    }
    this.#heard();
    // The core mends a mesh in one go, which takes seconds if the mesh is large.
    if (message.type === 'opening' || message.type === 'open_progress') this.#deadline = this.#clock.now() + LOADING_MS;
    if (message.type === 'failed') {
      this.#drop();
      this.state = 'failed';
    }
    if (message.type === 'crashed') {
      this.#replace('panic', message.message, message.stack);
      return;
    }
    this.#watch();
    this.#onMessage(message);
  }

  /** How long the worker may be silent. No input can hang it while it loads, but a browser may compile for long. */
  get #patience() {
    return this.state === 'loading' ? LOADING_MS : SILENCE_MS;
  }

  #heard() {
    this.#deadline = this.#clock.now() + this.#patience;
  }

  #watch() {
    const on = this.worker !== null && (this.#busy || this.state === 'loading');
    if (!on) {
      this.#rest();
    } else if (this.#timer === undefined) {
      this.#timer = this.#clock.setTimeout(() => this.#check(false), Math.max(1, this.#deadline - this.#clock.now()));
    }
  }

  /** @param {boolean} again */
  #check(again) {
    this.#timer = undefined;
    if (this.#clock.now() < this.#deadline) this.#watch();
    else if (!again) this.#timer = this.#clock.setTimeout(() => this.#check(true), GRACE_MS);
    else if (this.state === 'loading') this.#fail(`no word from it for ${LOADING_MS / 1000} s`);
    else this.#replace('hang', `no word from the sampler for ${SILENCE_MS / 1000} s`, '');
  }

  /** Gives up on a worker that did not load. @param {string} message */
  #fail(message) {
    this.#drop();
    this.state = 'failed';
    this.#onLoadError(message);
  }

  #rest() {
    this.#clock.clearTimeout(this.#timer);
    this.#timer = undefined;
  }

  #drop() {
    this.#rest();
    const { worker } = this;
    this.worker = null;
    if (worker) {
      worker.onmessage = null;
      worker.onerror = null;
      worker.terminate();
    }
    this.#busy = false;
  }

  /** @param {Crash['cause']} cause @param {string} message @param {string} stack */
  #replace(cause, message, stack) {
    this.#drop();
    const now = this.#clock.now();
    this.restarts = [...this.restarts.filter((t) => now - t < WINDOW_MS), now];
    const crash = { cause, message, stack, restarts: this.restarts.length };
    if (this.restarts.length > RESTARTS) {
      this.state = 'safe';
      this.#onSafeMode(crash);
    } else {
      this.start();
      this.#onRestart(crash);
    }
  }

  stop() {
    this.#drop();
    this.state = 'off';
  }
}
