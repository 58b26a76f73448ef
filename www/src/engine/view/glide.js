/**
 * Animates particles from the positions last drawn to the present ones, so that a relaxation step appears as a motion,
 * and so does the run that takes the place of particles that have followed a surface.
 *
 * @module
 */
import { MOST_STEPPED } from '../constants.js';

/** Duration of the motion: long enough to be seen, and shorter than the usual interval between relaxation steps. */
const GLIDE_S = 0.1;
/** Duration of the motion from other particles to those of a run. */
const MEET_S = 0.25;

export class Glide {
  /** Positions that were drawn last. */
  #shown;
  #from;
  #startS;
  #durationS;

  constructor() {
    this.#shown = new Float32Array(0);
    this.count = 0;
    this.#from = new Float32Array(0);
    this.#startS = -Infinity;
    this.#durationS = GLIDE_S;
    this.active = false;
    /** Whether the particles that come next start from those drawn last, wherever these are near. */
    this.meets = false;
  }

  /** Drops the positions, because another surface follows. */
  forget() {
    this.count = 0;
    this.active = false;
    this.meets = false;
  }

  /** Starts a motion of particles that are already drawn. @param {number} nowS */
  begin(nowS) {
    this.#from = this.#shown.slice(0, 3 * this.count);
    this.#start(nowS, GLIDE_S);
  }

  /**
   * Starts a motion of new particles, each from the nearest of those drawn last.
   * @param {Float32Array} positions  of the new particles
   * @param {number} count
   * @param {number} reach  distance within which one is looked for
   * @param {number} nowS
   */
  meet(positions, count, reach, nowS) {
    const drawn = this.#shown.subarray(0, 3 * this.count);
    this.#from = nearestTo(positions.subarray(0, 3 * count), drawn, reach);
    this.count = 0;
    this.#start(nowS, MEET_S);
  }

  /** @param {number} nowS @param {number} durationS */
  #start(nowS, durationS) {
    this.#startS = nowS;
    this.#durationS = durationS;
    this.meets = false;
    this.active = true;
  }

  /**
   * Returns the positions at which the particles are drawn at this time.
   * @param {Float32Array} positions  the present positions
   * @param {number} count
   * @param {number} nowS
   */
  between(positions, count, nowS) {
    const t = Math.min(1, Math.max(0, (nowS - this.#startS) / this.#durationS));
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

/**
 * Returns for each place the nearest of others, or the place itself if none is within reach.
 * @param {Float32Array} places @param {Float32Array} others
 * @param {number} reach
 */
function nearestTo(places, others, reach) {
  const cell = (/** @type {Float32Array} */ of, /** @type {number} */ i) => Math.floor(of[i] / reach);
  const key = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) => (x * 4096 + y) * 4096 + z;
  /** @type {Map<number, number[]>} */
  const cells = new Map();
  for (let j = 0; j < others.length; j += 3) {
    const at = key(cell(others, j), cell(others, j + 1), cell(others, j + 2));
    const listed = cells.get(at);
    if (listed) listed.push(j);
    else cells.set(at, [j]);
  }
  const found = places.slice();
  for (let i = 0; i < places.length; i += 3) {
    const [x, y, z] = [0, 1, 2].map((k) => cell(places, i + k));
    let least = reach * reach;
    for (let n = 0; n < 27; n += 1) {
      const near = cells.get(key(x + (n % 3) - 1, y + (((n / 3) | 0) % 3) - 1, z + ((n / 9) | 0) - 1)) ?? [];
      for (const j of near) {
        const distance =
          (places[i] - others[j]) ** 2 + (places[i + 1] - others[j + 1]) ** 2 + (places[i + 2] - others[j + 2]) ** 2;
        if (distance < least) {
          least = distance;
          found.set(others.subarray(j, j + 3), i);
        }
      }
    }
  }
  return found;
}
