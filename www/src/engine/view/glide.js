/**
 * The way of particles from where they were drawn to where they now are: a relaxation step is seen as a motion and not as a
 * jump. Only for as many particles as can be told to the graphics card anew in every frame.
 *
 * @module
 */

/** Beyond this many particles the copies would cost more than the motion shows. */
export const MOST_GLIDING = 20_000;
/** Long enough to be seen, short enough that the next step of a running relaxation is not waited for. */
const GLIDE_S = 0.1;

export class Glide {
  constructor() {
    /** Positions as last drawn. */
    this.shown = new Float32Array(0);
    this.count = 0;
    this.from = new Float32Array(0);
    this.startS = -Infinity;
    this.active = false;
  }

  /** Another surface: nothing glides from one to the next. */
  forget() {
    this.count = 0;
    this.active = false;
  }

  /** Particles that are already drawn have moved. @param {number} nowS */
  begin(nowS) {
    this.from = this.shown.slice(0, 3 * this.count);
    this.startS = nowS;
    this.active = true;
  }

  /**
   * Where to draw the particles now.
   * @param {Float32Array} positions  where they are going
   * @param {number} count
   * @param {number} nowS
   */
  between(positions, count, nowS) {
    const t = Math.min(1, Math.max(0, (nowS - this.startS) / GLIDE_S));
    if (t === 1) this.active = false;
    const eased = t * (2 - t);
    const out = positions.slice(0, 3 * count);
    const n = Math.min(this.from.length, out.length);
    for (let i = 0; i < n; i += 1) out[i] = this.from[i] + (out[i] - this.from[i]) * eased;
    return out;
  }

  /** These positions were drawn. @param {Float32Array} positions @param {number} first @param {number} last */
  note(positions, first, last) {
    if (last > MOST_GLIDING) {
      this.forget();
      return;
    }
    if (this.shown.length < 3 * last) {
      const grown = new Float32Array(3 * MOST_GLIDING);
      grown.set(this.shown);
      this.shown = grown;
    }
    this.shown.set(positions.subarray(3 * first, 3 * last), 3 * first);
    this.count = Math.max(this.count, last);
  }
}
