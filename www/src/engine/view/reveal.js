/**
 * The pace at which a new surface appears. A sampler that is done in a blink shows nothing of how it works, so the picture
 * lets the generation levels appear one after another, in their true order, within a little more than a second. A slow run is
 * shown as it comes.
 *
 * @module
 */

/** Time for a whole surface, whatever its number of levels. */
const WHOLE_S = 1.1;
/** Bounds on the time between two levels: below one frame nothing is gained, above the eye waits. */
const FASTEST_S = 1 / 120;
const SLOWEST_S = 0.06;
/** Levels assumed while the front is still running: a surface at the paper's usual radius has about so many. */
const USUAL_LEVELS = 90;

export class Reveal {
  constructor() {
    this.active = false;
    this.startS = 0;
    this.stepS = 0;
    /** Second at which each level appears. @type {number[]} */
    this.births = [];
  }

  /** @param {number} nowS */
  begin(nowS) {
    this.active = true;
    this.startS = nowS;
    this.stepS = Math.min(SLOWEST_S, Math.max(FASTEST_S, WHOLE_S / USUAL_LEVELS));
    this.births = [];
  }

  end() {
    this.active = false;
    this.births = [];
  }

  /**
   * Second at which a level appears; fixed the first time it is asked for. Levels come in order.
   * @param {number} level @param {number} nowS
   */
  birthOf(level, nowS) {
    if (!this.active) return -Infinity;
    for (let k = this.births.length; k <= level; k += 1) {
      const after = k === 0 ? nowS : this.births[k - 1] + this.stepS;
      this.births.push(Math.max(after, nowS));
    }
    return this.births[level];
  }

  /**
   * Runs of particles that appear at the same time: one while nothing is being revealed, else one for each level.
   * @param {Uint32Array} levels @param {number} first @param {number} last @param {number} nowS
   * @returns {[number, number, number][]} first, last and second of appearance of each
   */
  runs(levels, first, last, nowS) {
    if (!this.active) return [[first, last, -Infinity]];
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

  /** The last level that has begun to appear, −1 before the first. @param {number} nowS */
  levelAt(nowS) {
    let k = this.births.length - 1;
    while (k >= 0 && this.births[k] > nowS) k -= 1;
    return k;
  }

  /** Second at which everything known so far is there. */
  endS() {
    return this.births.length ? this.births[this.births.length - 1] : this.startS;
  }
}
