/**
 * Computes how far the picture is dimmed. It fades gradually while the surface on the page is not the requested one.
 *
 * @module
 */

/** Duration of the fade in either direction. */
const DIM_S = 0.15;
const DIM = 0.62;

export class Dimmer {
  #from;
  #to;
  #startS;
  /** The share that was read last. */
  #read;

  constructor() {
    this.#from = 0;
    this.#to = 0;
    this.#startS = -Infinity;
    this.#read = 0;
  }

  /** Whether the picture is dimmed or dimming. */
  get on() {
    return this.#to > 0;
  }

  /**
   * @param {boolean} on
   * @param {number} nowS
   * @param {boolean} calm  without a transition
   * @returns whether the state changed
   */
  set(on, nowS, calm) {
    const to = on ? DIM : 0;
    if (to === this.#to) return false;
    this.#from = this.at(nowS, calm);
    this.#to = to;
    this.#startS = nowS;
    return true;
  }

  /** Returns the share by which the picture is dimmed. @param {number} nowS @param {boolean} calm */
  at(nowS, calm) {
    const t = calm ? 1 : Math.min(1, (nowS - this.#startS) / DIM_S);
    this.#read = t < 1 ? this.#from + (this.#to - this.#from) * t : this.#to;
    return this.#read;
  }

  /** Whether the share that was read last is not the final one, however long ago: painting may take longer. */
  get moving() {
    return this.#read !== this.#to;
  }
}
