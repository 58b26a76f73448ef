/**
 * Decides how much of a picture is drawn while it moves, by the time that its frames take on this machine. A picture
 * that stands still is whole.
 *
 * @module
 */

/** @import { BackendKind } from '../types.js' */
/** @import { Quality } from './types.js' */

/** Time of a painted frame that is aimed at: the rest of 60 ms is the browser's and the sampler's. */
const TARGET_MS = 40;
/** Smallest share of the pixels of a side that is painted. Below it a disc is hardly a disc. */
const LEAST_SHARE = 0.4;
/** Most particles in whose place one is painted. */
const MOST_STRIDE = 64;
/** Frames by which a graphics card is judged, after the first, and the median time above which it is slow. */
const JUDGED = 10;
const SLOW_MS = 50;

/** @type {Quality} */
export const WHOLE = { share: 1, body: true, stride: 1 };
/** What a slow graphics card draws of a picture that moves. @type {Quality} */
const LIGHT = { share: 0.5, body: false, stride: 1 };

/** @param {number[]} values */
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

export class Effort {
  #isPainted = false;
  #share = 1;
  #stride = 1;
  /** Times of the frames of a card that is not judged yet; null afterwards. @type {number[] | null} */
  #times = null;
  #isSlow = false;

  /** Begins anew with a device. @param {BackendKind} kind @param {number} ratio  canvas pixels per page pixel */
  begin(kind, ratio) {
    this.#isPainted = kind === 'canvas2d';
    this.#share = 1 / Math.max(1, ratio);
    this.#stride = 1;
    this.#times = this.#isPainted ? null : [];
    this.#isSlow = false;
  }

  /** Whether a picture that moves may be less than whole. */
  get isReduced() {
    return this.#isPainted || this.#isSlow;
  }

  /** What is drawn of a picture that moves, or that stands still. @param {boolean} isMoving @returns {Quality} */
  of(isMoving) {
    if (!isMoving || !this.isReduced) return WHOLE;
    return this.#isPainted ? { share: this.#share, body: true, stride: this.#stride } : LIGHT;
  }

  /**
   * Notes how long a frame that moved has taken to be painted. Its time goes with its pixels, and where even the
   * fewest take too long, with its particles.
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

  /** Notes the time between two frames of a motion in sight, by which a card is judged once. @param {number} ms */
  passed(ms) {
    if (!this.#times) return;
    this.#times.push(ms);
    if (this.#times.length <= JUDGED) return;
    this.#isSlow = median(this.#times.slice(1)) > SLOW_MS;
    this.#times = null;
  }
}
