/**
 * Keeps a graphics device open: opens the best one, reopens it after a loss, and falls back to the next kind after
 * repeated losses. If WebGL is software instead of a graphics card, the painter is best: it takes a fraction of the
 * time for nearly the same picture.
 *
 * Browsers keep about 16 contexts alive across all frames of a page, and take the oldest away for a new one. A picture
 * out of sight that loses its device therefore does not take another frame's: it is drawn as dots until it is visible
 * again.
 *
 * @module
 */
import { LOADING_MS } from '../bundle/load.js';
import { bestKind } from '../probe/index.js';
import { BACKENDS, DeviceLost, openDevice } from './backends.js';

/** @import { Device, DeviceOptions } from './types.js' */

/** The painter's rank. */
const PAINTER = BACKENDS.indexOf('canvas2d');
/** Time window in which losses of one kind of device are counted. */
const WINDOW_MS = 60_000;
/** Number of losses after which the same kind is reopened. One more loss leads to the next kind. */
const TRIES = 3;
/** Delay before each attempt, because a graphics process takes a moment to restart. */
const WAIT_MS = [0, 300, 1000];

export class DeviceKeeper {
  #host;
  #onOpen;
  #onLost;
  #onFallback;
  #open;
  #clock;
  #first;
  #rank;

  /**
   * Whether the picture is known to be visible. The browser reports it with its first frame. Until then a lost device
   * is not reopened; otherwise the pictures of an opening page would take contexts from one another.
   */
  #inSight;

  /** Whether dots replace a device that was lost out of sight. */
  #resting;

  /** A substitute to draw on until the first device has opened and drawn. @type {Device | null} */
  #standIn;
  /** Resolves once the substitute is open, or is not needed. @type {Promise<void> | null} */
  #standing = null;
  #probe;

  /** @param {DeviceOptions} options */
  constructor({ host, onOpen, onLost, onFallback, first = null, probe = bestKind, open = openDevice, clock }) {
    this.#host = host;
    this.#onOpen = onOpen;
    this.#onLost = onLost;
    this.#onFallback = onFallback;
    this.#open = open;
    this.#clock = clock ?? {
      now: () => performance.now(),
      wait: (ms) => new Promise((resolve) => setTimeout(resolve, ms)),
    };
    /** The rank of the first kind to try; null before the machine was probed. @type {number | null} */
    this.#first = first ? BACKENDS.indexOf(first) : null;
    this.#rank = this.#first ?? 0;
    /** @type {Device | null} */
    this.device = null;
    /** Counter of device changes, to recognise late answers. */
    this.epoch = 0;
    /** @type {number[]} */
    this.losses = [];
    /** Number of devices opened so far. */
    this.opened = 0;
    this.#inSight = false;
    this.#resting = false;
    this.#standIn = null;
    this.#probe = probe;
    /** Reject functions of the promises that wait for the device. @type {Set<(error: Error) => void>} */
    this.waiting = new Set();
  }

  /** Opens the first working device, beginning with the current rank. */
  async start() {
    this.epoch += 1;
    const { epoch } = this;
    if (this.#first === null) {
      this.#first = BACKENDS.indexOf(await this.#probe());
      if (this.epoch !== epoch) return;
      this.#rank = this.#first;
    }
    for (; this.#rank < BACKENDS.length; this.#rank += 1) {
      const kind = BACKENDS[this.#rank];
      if (this.#rank === PAINTER) await this.#standing;
      if (this.epoch !== epoch) return;
      if (this.#standIn && this.#rank === PAINTER) {
        this.#take(this.#standIn);
        this.#standIn = null;
        return;
      }
      try {
        const events = {
          onLost: (/** @type {string} */ reason, /** @type {string} */ message) => {
            if (this.epoch === epoch) this.lost(`${reason}: ${message}`);
          },
          onError: (/** @type {string} */ message) => {
            // The device reports an error; reopening the same kind would not help.
            if (this.epoch === epoch) this.giveUp(message);
          },
        };
        const opening = this.#open(kind, this.#host, events);
        const device = await Promise.race([opening, this.#clock.wait(LOADING_MS).then(() => null)]);
        if (device && this.epoch === epoch) {
          this.#take(device);
          return;
        }
        // A device that opens too late is closed.
        opening.then(
          (late) => late.dispose(),
          () => {},
        );
        if (this.epoch !== epoch) return;
        this.#onFallback(kind, `it has not opened within ${LOADING_MS / 1000} s`, true);
      } catch (error) {
        if (this.epoch !== epoch) return;
        if (error instanceof DeviceLost) return this.lost(error.message);
        this.#onFallback(
          kind,
          error instanceof Error ? error.message : String(/** @type {any} */ (error)?.message ?? error),
        );
      }
    }
  }

  /** @param {Device} device */
  #take(device) {
    this.device = device;
    this.opened += 1;
    this.#onOpen(device, false);
  }

  /** Draws on a 2-D canvas until the first device is open; its bundle loads as long as the core. */
  standIn() {
    this.#standing = this.#stand();
    return this.#standing;
  }

  async #stand() {
    const { epoch } = this;
    if (this.#rank === PAINTER) return;
    const device = await this.#open('canvas2d', this.#host, { onLost: () => {}, onError: () => {} }).catch(() => null);
    if (!device || this.epoch !== epoch || this.device) return device?.dispose();
    this.#standIn = device;
    this.device = device;
    this.#onOpen(device, true);
  }

  /** Records that the current device has drawn, so that its substitute is no longer seen. */
  drew() {
    if (this.#standIn === this.device) return;
    this.#standIn?.dispose();
    this.#standIn = null;
  }

  /** Draws dots on a 2-D canvas, which needs no graphics context, until the picture is visible. */
  async #rest() {
    this.#resting = true;
    const { epoch } = this;
    const device = await this.#open('canvas2d', this.#host, { onLost: () => {}, onError: () => {} });
    if (this.epoch === epoch) this.#take(device);
    else device.dispose();
  }

  /**
   * Records whether the picture is visible. A device that was lost out of sight is opened again.
   * @param {boolean} inSight
   */
  seen(inSight) {
    this.#inSight = inSight;
    if (!inSight || !this.#resting) return;
    this.close();
    void this.start();
  }

  /** Starts again with the best kind, at the user's request. */
  retry() {
    this.close();
    this.losses = [];
    this.#rank = this.#first ?? 0;
    return this.start();
  }

  close() {
    this.#resting = false;
    this.epoch += 1;
    this.device?.dispose();
    this.device = null;
    this.drew();
    for (const refuse of this.waiting) refuse(new Error('the graphics device is lost'));
  }

  /**
   * Returns the device's answer, or rejects when the device is closed: a trapped one never answers.
   * @template T @param {Promise<T>} answer @returns {Promise<T>}
   */
  answered(answer) {
    return new Promise((resolve, reject) => {
      this.waiting.add(reject);
      answer.then(resolve, reject).finally(() => this.waiting.delete(reject));
    });
  }

  /** @param {string} message */
  lost(message) {
    const kind = BACKENDS[this.#rank];
    this.close();
    if (!this.#inSight) {
      void this.#rest();
      return;
    }
    const { epoch } = this;
    const now = this.#clock.now();
    this.losses = [...this.losses.filter((t) => now - t < WINDOW_MS), now];
    if (this.losses.length > TRIES) {
      this.losses = [];
      this.#rank += 1;
      this.#onFallback(kind, message);
    } else {
      this.#onLost(kind, message);
    }
    const wait = WAIT_MS[Math.max(0, this.losses.length - 1)] ?? 0;
    void this.#clock.wait(wait).then(() => (this.epoch === epoch ? this.start() : undefined));
  }

  /** Abandons this kind of device and opens the next one. @param {string} message */
  giveUp(message) {
    const kind = BACKENDS[this.#rank];
    this.close();
    this.losses = [];
    this.#rank = Math.min(this.#rank + 1, BACKENDS.length - 1);
    this.#onFallback(kind, message);
    void this.start();
  }
}
