/**
 * Keeps a device at hand: opens the best one, opens it again when it is lost, and goes to the next kind when that does not help.
 *
 * @module
 */
import { BACKENDS, openDevice } from './backends.js';

/**
 * @typedef {import('./backends.js').Device} Device
 * @typedef {import('./backends.js').BackendKind} BackendKind
 */

/** Losses of one kind of device within this time are counted together. */
const WINDOW_MS = 60_000;
/** As many losses are mended with the same kind; the next one goes to the next kind. */
export const TRIES = 3;
/** Waits before each try: a graphics process that restarts needs a moment. */
const WAIT_MS = [0, 300, 1000];

export class DeviceKeeper {
  /**
   * @param {object} options
   * @param {HTMLElement} options.host
   * @param {(device: Device) => void} options.onOpen  a device is there, empty; fill it
   * @param {(kind: BackendKind, message: string) => void} options.onLost  it is gone, another is being opened
   * @param {(kind: BackendKind, message: string) => void} options.onFallback  a kind of device was given up
   * @param {BackendKind | null} [options.first]  where to begin
   * @param {typeof openDevice} [options.open]
   * @param {{now: () => number, wait: (ms: number) => Promise<void>}} [options.clock]
   */
  constructor({ host, onOpen, onLost, onFallback, first = null, open = openDevice, clock }) {
    this.host = host;
    this.onOpen = onOpen;
    this.onLost = onLost;
    this.onFallback = onFallback;
    this.open = open;
    this.clock = clock ?? {
      now: () => performance.now(),
      wait: (ms) => new Promise((resolve) => setTimeout(resolve, ms)),
    };
    this.rank = first ? BACKENDS.indexOf(first) : 0;
    /** @type {Device | null} */
    this.device = null;
    /** Goes up with every change of device, so that late answers are known as such. */
    this.epoch = 0;
    /** @type {number[]} */
    this.losses = [];
    /** Devices opened so far. */
    this.opened = 0;
  }

  /** Opens the first device from the present rank on that works. @returns {Promise<void>} */
  async start() {
    this.epoch += 1;
    const { epoch } = this;
    for (; this.rank < BACKENDS.length; this.rank += 1) {
      const kind = BACKENDS[this.rank];
      try {
        const device = await this.open(kind, this.host, {
          onLost: (reason, message) => {
            if (this.epoch === epoch) this.lost(`${reason}: ${message}`);
          },
          onError: (message) => {
            // The device refuses what it is told: asking again would change nothing.
            if (this.epoch === epoch) this.giveUp(message);
          },
        });
        if (this.epoch !== epoch) {
          device.dispose();
          return;
        }
        this.device = device;
        this.opened += 1;
        this.onOpen(device);
        return;
      } catch (error) {
        if (this.epoch !== epoch) return;
        if (kind !== 'canvas2d')
          this.onFallback(
            kind,
            error instanceof Error ? error.message : String(/** @type {any} */ (error)?.message ?? error),
          );
      }
    }
  }

  close() {
    this.epoch += 1;
    this.device?.dispose();
    this.device = null;
  }

  /** @param {string} message */
  lost(message) {
    const kind = BACKENDS[this.rank];
    this.close();
    const { epoch } = this;
    const now = this.clock.now();
    this.losses = [...this.losses.filter((t) => now - t < WINDOW_MS), now];
    if (this.losses.length > TRIES) {
      this.losses = [];
      this.rank += 1;
      this.onFallback(kind, message);
    } else {
      this.onLost(kind, message);
    }
    const wait = WAIT_MS[Math.max(0, this.losses.length - 1)] ?? 0;
    void this.clock.wait(wait).then(() => (this.epoch === epoch ? this.start() : undefined));
  }

  /** This kind of device is of no use here. @param {string} message */
  giveUp(message) {
    const kind = BACKENDS[this.rank];
    this.close();
    this.losses = [];
    this.rank = Math.min(this.rank + 1, BACKENDS.length - 1);
    this.onFallback(kind, message);
    void this.start();
  }
}
