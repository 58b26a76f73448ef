/**
 * The particles on the main thread: one typed column per attribute, grown by doubling. This copy is what the exports write,
 * what the pointer picks from and what a lost graphics device is rebuilt from.
 *
 * @module
 */

/** Parent index of a seed, as the core writes it. */
export const NO_PARENT = 0xffffffff;
/** Slot fates as the core numbers them. */
export const FATE = { open: 0, parent: 1, added: 2, matched: 3, notConverged: 4, outside: 5, undefined: 6, capped: 7 };
/** Set in `slots` where the surface has a singular point within 2r of the particle. */
export const SINGULAR = 1 << 30;
/** Level of what is drawn with the particles and is none of them. */
export const NO_LEVEL = 0xffffffff;

/**
 * A piece of the columns as the worker posts it: particles `first … first + n`, or with `slots` alone newer fates of
 * particles from `slotsFrom` on.
 * @typedef {object} Piece
 * @property {number} first
 * @property {number} total  particles after this piece
 * @property {Float32Array} positions
 * @property {Float32Array} normals
 * @property {Float32Array} radii
 * @property {Uint32Array} levels
 * @property {Uint32Array} parents
 */

export class Columns {
  constructor() {
    this.count = 0;
    /** The last generation level that there is. */
    this.lastLevel = 0;
    /** Whether these are the particles of an earlier field, shown for want of others: the present one has no surface. */
    this.stale = false;
    /** Whether the particles are of an adaptive run, which says how `slots` are to be read. */
    this.adaptive = false;
    this.positions = new Float32Array(0);
    this.normals = new Float32Array(0);
    this.radii = new Float32Array(0);
    this.levels = new Uint32Array(0);
    this.parents = new Uint32Array(0);
    this.slots = new Uint32Array(0);
    /** Per-particle figures of the report; null until it is there. @type {Uint8Array | null} */
    this.valence = null;
    /** @type {Float32Array | null} */
    this.nearest = null;
    /** @type {Float32Array | null} */
    this.residual = null;
    /** Connected piece, 0 the largest. @type {Uint32Array | null} */
    this.component = null;
    /** Principal curvatures, two per particle, of the first `curved` particles; asked of the core only when they are shown. */
    this.curvature = new Float32Array(0);
    this.curved = 0;
  }

  /** Another run begins. @param {boolean} [adaptive] */
  clear(adaptive = false) {
    this.count = 0;
    this.lastLevel = 0;
    this.stale = false;
    this.curved = 0;
    this.adaptive = adaptive;
    this.forget();
  }

  /** The figures of the report no longer hold. */
  forget() {
    this.valence = null;
    this.nearest = null;
    this.residual = null;
    this.component = null;
  }

  /** Room for `n` particles; what is there stays. @param {number} n */
  reserve(n) {
    if (n <= this.radii.length) return;
    const room = Math.max(n, 2 * this.radii.length, 1024);
    /** @template {Float32Array | Uint32Array} T @param {T} old @param {number} width @returns {T} */
    const grown = (old, width) => {
      const next = /** @type {T} */ (new /** @type {any} */ (old.constructor)(room * width));
      next.set(old);
      return next;
    };
    this.positions = grown(this.positions, 3);
    this.normals = grown(this.normals, 3);
    this.radii = grown(this.radii, 1);
    this.levels = grown(this.levels, 1);
    this.parents = grown(this.parents, 1);
    this.slots = grown(this.slots, 1);
  }

  /**
   * Writes a piece. Pieces arrive in order, so that `first` never lies beyond the particles present.
   * @param {Piece} piece
   * @returns {boolean} false, and nothing written, when the piece does not fit what is here
   */
  write(piece) {
    const n = piece.radii.length;
    const { first, total } = piece;
    if (first > this.count || first + n > total || piece.positions.length !== 3 * n || piece.normals.length !== 3 * n)
      return false;
    this.reserve(total);
    this.positions.set(piece.positions, 3 * first);
    this.normals.set(piece.normals, 3 * first);
    this.radii.set(piece.radii, first);
    this.levels.set(piece.levels, first);
    this.parents.set(piece.parents, first);
    this.slots.fill(0, Math.max(first, this.count), first + n);
    this.count = total;
    for (const level of piece.levels) if (level > this.lastLevel) this.lastLevel = level;
    if (n > 0) this.forget();
    return true;
  }

  /** Principal curvatures of particles from `from` on, which follow those that are known. @param {number} from @param {Float32Array} values */
  writeCurvature(from, values) {
    if (from > this.curved || 2 * from + values.length > 2 * this.count) return;
    if (this.curvature.length < 2 * this.count) {
      const grown = new Float32Array(2 * this.radii.length);
      grown.set(this.curvature.subarray(0, 2 * this.curved));
      this.curvature = grown;
    }
    this.curvature.set(values, 2 * from);
    this.curved = Math.max(this.curved, from + values.length / 2);
  }

  /**
   * The figures of the report, one value per particle. Those of other particles are left out.
   * @param {{valence: Uint8Array, nearest: Float32Array, residual: Float32Array, component: Uint32Array}} figures
   */
  writeFigures({ valence, nearest, residual, component }) {
    if (valence.length !== this.count) return;
    this.valence = valence;
    this.nearest = nearest;
    this.residual = residual;
    this.component = component.length === this.count ? component : null;
  }

  /** Newer fates of the slots of particles from `from` on. @param {number} from @param {Uint32Array} slots */
  writeSlots(from, slots) {
    if (from + slots.length > this.count) return;
    this.slots.set(slots, from);
  }

  /** The smallest box around the particles with their discs, or null without any. @returns {import('./types.js').Bounds | null} */
  bounds() {
    if (this.count === 0) return null;
    const min = [Infinity, Infinity, Infinity];
    const max = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.count; i += 1) {
      const r = this.radii[i];
      for (let k = 0; k < 3; k += 1) {
        const v = this.positions[3 * i + k];
        if (v - r < min[k]) min[k] = v - r;
        if (v + r > max[k]) max[k] = v + r;
      }
    }
    return { min: /** @type {any} */ (min), max: /** @type {any} */ (max) };
  }
}
