/**
 * Decides how much of a moving picture is drawn, by the time that frames take on this machine. A still picture is drawn
 * completely.
 *
 * @module
 */

/** @import { BackendKind } from '../types.js' */
/** @import { Quality } from './types.js' */

/** Target time of a painted frame; the browser and the sampler use the rest of 60 ms. */
const TARGET_MS = 40;
/** Smallest share of the pixels along a side that is painted; with fewer, discs are hard to recognise. */
const LEAST_SHARE = 0.4;
/** Most particles that one painted particle may stand for. */
const MOST_STRIDE = 64;
/** Frames by which a graphics card is judged, after the first one, and the median time above which it is slow. */
const JUDGED = 10;
const SLOW_MS = 50;

/** @type {Quality} */
export const WHOLE = { share: 1, body: true, stride: 1 };
/** How a slow graphics card draws a moving picture. @type {Quality} */
const LIGHT = { share: 0.5, body: false, stride: 1 };

/** @param {number[]} values */
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

export class Effort {
  #isPainted = false;
  #share = 1;
  #stride = 1;
  /** Frame times of a card that is not judged yet; null afterwards. @type {number[] | null} */
  #times = null;
  #isSlow = false;

  /** Starts with a device. @param {BackendKind} kind @param {number} ratio canvas pixels per page pixel */
  begin(kind, ratio) {
    this.#isPainted = kind === 'canvas2d';
    this.#share = 1 / Math.max(1, ratio);
    this.#stride = 1;
    this.#times = this.#isPainted ? null : [];
    this.#isSlow = false;
  }

  /** Whether a moving picture may be drawn incompletely. */
  get isReduced() {
    return this.#isPainted || this.#isSlow;
  }

  /** How a moving or a still picture is drawn. @param {boolean} isMoving @returns {Quality} */
  of(isMoving) {
    if (!isMoving || !this.isReduced) return WHOLE;
    return this.#isPainted ? { share: this.#share, body: true, stride: this.#stride } : LIGHT;
  }

  /**
   * Records the painting time of a moving frame. The time depends on the pixels and, if even the fewest take too long,
   * on the particles.
   * @param {number} ms
   */
  painted(ms) {
    const load = ms / TARGET_MS;
    if (load > 1) {
      if (this.#share > LEAST_SHARE) this.#share = Math.max(LEAST_SHARE, this.#share * Math.max(0.6, load ** -0.5));
      else this.#stride = Math.min(MOST_STRIDE, 2 * this.#stride);
    } else if (load < 0.5) {
      if (this.#stride > 1) this.#stride /= 2;
      else this.#share = Math.min(1, 1.15 * this.#share);
    }
  }

  /** Records the time between two visible moving frames; a card is judged by these once. @param {number} ms */
  passed(ms) {
    if (!this.#times) return;
    this.#times.push(ms);
    if (this.#times.length <= JUDGED) return;
    this.#isSlow = median(this.#times.slice(1)) > SLOW_MS;
    this.#times = null;
  }
}
