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

  constructor() {
    this.#from = 0;
    this.#to = 0;
    this.#startS = -Infinity;
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
    return this.#from + (this.#to - this.#from) * t;
  }

  /** @param {number} nowS */
  moving(nowS) {
    return nowS - this.#startS < DIM_S;
  }
}
