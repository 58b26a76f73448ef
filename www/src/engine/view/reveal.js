/**
 * Sets the times at which the generation levels of a new surface appear. A fast sampler would finish before its front
 * can be seen, so the levels appear one after another within about a second. A slow run is shown as it progresses.
 *
 * @module
 */

/** Time between two levels: a surface of 90 levels, usual at the paper's radius, appears in 1.1 s. */
const STEP_S = 1.1 / 90;

export class Reveal {
  #startS;

  constructor() {
    this.active = false;
    this.#startS = 0;
    /** Time in seconds at which each level appears. @type {number[]} */
    this.births = [];
  }

  /** @param {number} nowS */
  begin(nowS) {
    this.active = true;
    this.#startS = nowS;
    this.births = [];
  }

  end() {
    this.active = false;
    this.births = [];
  }

  /**
   * Returns the time in seconds at which a level appears. The first call fixes it, and levels must come in order.
   * @param {number} level @param {number} nowS
   */
  birthOf(level, nowS) {
    if (!this.active) return -Infinity;
    for (let k = this.births.length; k <= level; k += 1) {
      const after = k === 0 ? nowS : this.births[k - 1] + STEP_S;
      this.births.push(Math.max(after, nowS));
    }
    return this.births[level];
  }

  /**
   * Returns the ranges of particles that appear together: one range without a reveal, otherwise one for each level.
   * @param {Uint32Array} levels @param {number} first @param {number} last
   * @param {{nowS: number, birthS?: number}} when  `birthS`: the time of appearance without a
   *   reveal
   * @returns {[number, number, number][]} first, last and time of appearance of each
   */
  runs(levels, first, last, { nowS, birthS = -Infinity }) {
    if (!this.active) return [[first, last, birthS]];
    /** @type {[number, number, number][]} */
    const out = [];
    for (let i = first; i < last; ) {
      const level = levels[i];
      let end = i + 1;
      while (end < last && levels[end] === level) end += 1;
      out.push([i, end, this.birthOf(level, nowS)]);
      i = end;
    }
    return out;
  }

  /** Returns the last level that has begun to appear, −1 before the first. @param {number} nowS */
  levelAt(nowS) {
    let k = this.births.length - 1;
    while (k >= 0 && this.births[k] > nowS) k -= 1;
    return k;
  }

  /** Returns the time in seconds at which all known levels have appeared. */
  endS() {
    return this.births.length ? this.births[this.births.length - 1] : this.#startS;
  }
}
