/**
 * Animates particles from the positions last drawn to the current ones, so that a relaxation step appears as motion.
 *
 * @module
 */
import { MOST_STEPPED } from '../constants.js';

/** Duration of the animation: long enough to be seen, but shorter than the usual interval between relaxation steps. */
const GLIDE_S = 0.1;

export class Glide {
  /** Positions that were drawn last. */
  #shown;
  #from;
  #startS;

  constructor() {
    this.#shown = new Float32Array(0);
    this.count = 0;
    this.#from = new Float32Array(0);
    this.#startS = -Infinity;
    this.active = false;
  }

  /** Forgets the positions, because another surface follows. */
  forget() {
    this.count = 0;
    this.active = false;
  }

  /** Starts an animation of particles that are already drawn. @param {number} nowS */
  begin(nowS) {
    this.#from = this.#shown.slice(0, 3 * this.count);
    this.#startS = nowS;
    this.active = true;
  }

  /**
   * Returns the positions of the particles at this time.
   * @param {Float32Array} positions  the present positions
   * @param {number} count
   * @param {number} nowS
   */
  between(positions, count, nowS) {
    const t = Math.min(1, Math.max(0, (nowS - this.#startS) / GLIDE_S));
    if (t === 1) this.active = false;
    const eased = t * (2 - t);
    const out = positions.slice(0, 3 * count);
    const n = Math.min(this.#from.length, out.length);
    for (let i = 0; i < n; i += 1) out[i] = this.#from[i] + (out[i] - this.#from[i]) * eased;
    return out;
  }

  /**
   * Records the positions that were drawn.
   * @param {Float32Array} positions
   * @param {number} first
   * @param {number} last
   */
  note(positions, first, last) {
    if (last > MOST_STEPPED) {
      this.forget();
      return;
    }
    if (this.#shown.length < 3 * last) {
      const grown = new Float32Array(3 * MOST_STEPPED);
      grown.set(this.#shown);
      this.#shown = grown;
    }
    this.#shown.set(positions.subarray(3 * first, 3 * last), 3 * first);
    this.count = Math.max(this.count, last);
  }
}
