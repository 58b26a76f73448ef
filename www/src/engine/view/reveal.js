/**
 * Sets the times at which the generation levels of a new surface appear. A fast sampler would finish before its front
 * could be seen, so the levels appear one after another. A slow run is shown as it progresses.
 *
 * The first surface of a visit waits for its whole front. So its complete body replaces the poster in the first
 * picture, and the levels grow on it.
 *
 * @module
 */

/** Time between two levels: a surface of 90 levels, usual at the paper's radius, appears in 1.1 s. */
const STEP_S = 1.1 / 90;
/** The same on a first visit: the 55 levels of the first surface appear in 2.6 s. */
const OPENING_STEP_S = 2.6 / 55;
/** Most levels that a frame may add, and the longest total time that a reveal waits for slow frames. */
const LEVELS_A_FRAME = 2;
const MOST_WAIT_S = 2;

export class Reveal {
  #startS;
  #stepS;

  /** Total time that it has waited for frames. */
  #waitedS;

  constructor() {
    this.active = false;
    /** Whether this is the first surface of a visit, and whether it is still waiting. */
    this.isOpening = false;
    this.isHeld = false;
    /** For each level of the first surface, the end of its particles. @type {number[]} */
    this.ends = [];
    this.#startS = 0;
    this.#stepS = STEP_S;
    this.#waitedS = 0;
    /** Time in seconds at which each level appears. @type {number[]} */
    this.births = [];
  }

  /** @param {number} nowS @param {boolean} [isOpening]  whether it is the first surface of a visit */
  begin(nowS, isOpening = false) {
    this.active = true;
    this.isOpening = isOpening;
    this.isHeld = isOpening;
    this.ends = [];
    this.#startS = nowS;
    this.#stepS = isOpening ? OPENING_STEP_S : STEP_S;
    this.#waitedS = 0;
    this.births = [];
  }

  /**
   * Lets the levels of the first surface grow from now on. Levels before the first visible one, on the far side, appear
   * at once.
   * @param {number} nowS @param {Uint32Array} levels  of its particles
   * @param {(particle: number) => boolean} [isSeen]
   */
  release(nowS, levels, isSeen = () => true) {
    this.isHeld = false;
    this.#startS = nowS;
    let first = Infinity;
    // Particles that fill holes come last, whatever their level.
    for (let i = 0, newest = 0; i < levels.length; i += 1) {
      newest = Math.max(newest, levels[i]);
      this.ends[newest] = i + 1;
      if (newest < first && isSeen(i)) first = newest;
    }
    for (let k = 0; k < this.ends.length; k += 1) {
      this.ends[k] ??= this.ends[k - 1] ?? 0;
      this.births[k] = nowS + Math.max(0, k - first) * this.#stepS;
    }
  }

  /**
   * Returns how many particles of the first surface have appeared; within a level they appear one by one.
   * @param {number} nowS
   */
  appeared(nowS) {
    const k = this.levelAt(nowS);
    if (k < 0) return 0;
    const before = this.ends[k - 1] ?? 0;
    const share = Math.min(1, (nowS - this.births[k]) / this.#stepS);
    return Math.max(1, before + Math.round(share * (this.ends[k] - before)));
  }

  /**
   * Returns how long the reveal waits, so that a frame adds few levels.
   * @param {number} passedS  since the last frame
   */
  wait(passedS) {
    if (!this.active || this.isHeld) return 0;
    const late = Math.max(0, passedS - LEVELS_A_FRAME * this.#stepS);
    const wait = Math.min(late, MOST_WAIT_S - this.#waitedS);
    this.#waitedS += wait;
    return wait;
  }

  end() {
    this.active = false;
    this.isHeld = false;
    this.isOpening = false;
    this.births = [];
  }

  /**
   * Returns the time in seconds at which a level appears. The first call fixes it, and levels must come in order.
   * @param {number} level @param {number} nowS
   */
  birthOf(level, nowS) {
    if (!this.active) return -Infinity;
    for (let k = this.births.length; k <= level; k += 1) {
      const after = k === 0 ? nowS : this.births[k - 1] + this.#stepS;
      this.births.push(Math.max(after, nowS));
    }
    return this.births[level];
  }

  /**
   * Returns the ranges of particles that appear together: one without a reveal, else one per level.
   * @param {Uint32Array} levels @param {number} first @param {number} last
   * @param {{nowS: number, birthS?: number}} when  `birthS`: the time of appearance without a
   *   reveal
   * @returns {[number, number, number][]} first, last and time of appearance of each
   */
  runs(levels, first, last, { nowS, birthS = -Infinity }) {
    if (!this.active || this.isOpening) return [[first, last, birthS]];
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
