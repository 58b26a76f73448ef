/**
 * Holds the particles on the main thread: one typed array (column) per attribute, grown by doubling. Exports, picking
 * and the recovery of a lost graphics device read this copy.
 *
 * @module
 */

import { FATE, MOST_SLOTS, NO_PARENT, SLOT_BITS } from './core-numbers.js';
import { vec } from './vector.js';

/** @import { Bounds, ColumnRange, Figures, FileRecord, Mesh, Pattern } from './types.js' */

/** Number of fates that a slot can have. */
export const FATES = 1 << SLOT_BITS;
/** Returns the fate of a slot. @param {number} slots  the fates of a particle @param {number} k  number of the slot */
export const fateOf = (slots, k) => (slots >>> (SLOT_BITS * k)) & (FATES - 1);
/**
 * Generation level that tells the renderer that a disc is not a particle, such as a model's points.
 */
export const NO_LEVEL = 0xffffffff;

/**
 * The columns of a report, one value per particle. `patch` and `particle` are empty on a surface with one patch, and
 * `periodic` unless opposite faces of the box are equal. A core has a method with each name.
 */
export const MEASURED = /** @type {const} */ ([
  'valence',
  'nearest',
  'residual',
  'energy',
  'component',
  'patch',
  'particle',
  'periodic',
]);

export class Columns {
  constructor() {
    /** Number of rows: one for each particle, or one on each side for those on creases and smooth joins. */
    this.count = 0;
    /** Number of particles. */
    this.particles = 0;
    /**
     * For each row on a crease, a smooth join or a tip, the first row of its particle. They come first; else empty.
     */
    this.twins = new Uint32Array(0);
    /** Pairs of rows that a crease connects. */
    this.segments = new Uint32Array(0);
    /** Pairs of rows on smooth joins, where patches meet without an edge. */
    this.seams = new Uint32Array(0);
    /** The last generation level. */
    this.lastLevel = 0;
    this.tally = noTally();
    /**
     * Whether the particles belong to an earlier field. They stay on the page because the current field has no surface.
     */
    this.stale = false;
    /** Whether the run was adaptive. The number of slots of a particle depends on it. */
    this.adaptive = false;
    /** @type {Pattern} */
    this.pattern = 'hexagonal';
    /** Whether the surface continues outside the clip box, according to the slots known so far. */
    this.isOpen = false;
    this.positions = new Float32Array(0);
    /**
     * Positions in double precision if the box is so far from the origin that single precision is not enough.
     */
    this.exact = new Float64Array(0);
    this.normals = new Float32Array(0);
    this.radii = new Float32Array(0);
    this.levels = new Uint32Array(0);
    this.parents = new Uint32Array(0);
    this.slots = new Uint32Array(0);
    /** Figures of the report, one value per particle; null until the report has arrived. @type {Uint8Array | null} */
    this.valence = null;
    /** @type {Float32Array | null} */
    this.nearest = null;
    /** @type {Float32Array | null} */
    this.residual = null;
    /** @type {Float32Array | null} */
    this.energy = null;
    /** Index of the particle's component; 0 is the largest. @type {Uint32Array | null} */
    this.component = null;
    /**
     * Index of the smooth patch on which the particle lies, and the first row of the particle: a particle on a crease
     * or a smooth join has a row on each side. Null without these.
     * @type {Uint32Array | null}
     */
    this.patch = null;
    /** @type {Uint32Array | null} */
    this.particle = null;
    /** The first row of the particle on a lower face of a cell that this one repeats. @type {Uint32Array | null} */
    this.periodic = null;
    /**
     * Principal curvatures of the first `curved` particles, two values each. They are requested from the core only
     * while they are shown.
     */
    this.curvature = new Float32Array(0);
    this.curved = 0;
    /** The value by which the particles are coloured; null before it is known. @type {Float32Array | null} */
    this.value = null;
    /**
     * The colours that the surface has: `colour`, or `red`, `green` and `blue` from 0 to 1. Null before the report.
     * @type {Record<string, Float32Array> | null}
     */
    this.own = null;
    /**
     * Positions before each relaxation step; the first are those of the front, and the only ones if particles are many.
     * Empty before the end of a relaxation. Kept until the next run, even while no level is shown: only the whole run
     * could compute them again, and they take 12 bytes per particle, against 57 for all columns.
     * @type {Float32Array[]}
     */
    this.past = [];
    /** Index of the past positions that are drawn; null for the current ones. @type {number | null} */
    this.step = null;
    /** The mesh over the particles, while it is drawn. @type {Mesh | null} */
    this.mesh = null;
    /** How the particles were made; null before the end of their run. @type {FileRecord | null} */
    this.record = null;
  }

  /** Removes all particles, for a new run. @param {boolean} [adaptive] @param {Pattern} [pattern] */
  clear(adaptive = false, pattern = 'hexagonal') {
    this.count = 0;
    this.particles = 0;
    this.twins = new Uint32Array(0);
    this.segments = new Uint32Array(0);
    this.seams = new Uint32Array(0);
    this.lastLevel = 0;
    this.tally = noTally();
    this.stale = false;
    this.curved = 0;
    this.adaptive = adaptive;
    this.pattern = pattern;
    this.isOpen = false;
    this.past = [];
    this.exact = new Float64Array(0);
    this.forget();
  }

  /** Whether a row repeats its particle's first row. @param {number} i */
  isFurther(i) {
    return this.firstRow(i) !== i;
  }

  /** Returns the first row of the particle of a row. @param {number} i */
  firstRow(i) {
    return i < this.twins.length ? this.twins[i] : i;
  }

  /**
   * Returns the kind of curve on which the particle of a first row lies, preferring the crease; null if on none.
   * @param {number} i
   * @returns {'crease' | 'smooth join' | null}
   */
  curveAt(i) {
    if (i >= this.twins.length) return null;
    if (this.segments.includes(i)) return 'crease';
    return this.seams.includes(i) ? 'smooth join' : null;
  }

  /** The kinds of curves from which the fronts start. */
  get curves() {
    return [...(this.segments.length > 0 ? ['creases'] : []), ...(this.seams.length > 0 ? ['smooth joins'] : [])];
  }

  /** The positions to draw. */
  get shown() {
    const past = this.step === null ? undefined : this.past[this.step];
    return past && past.length >= 3 * this.count ? past : this.positions;
  }

  /** The positions where the front placed the particles, if known. */
  get placed() {
    const [first] = this.past;
    return first && first.length >= 3 * this.count ? first : this.positions;
  }

  /** Removes the report's figures, the mesh and the record, which no longer describe the particles. */
  forget() {
    for (const name of MEASURED) this[name] = null;
    this.value = null;
    this.own = null;
    this.mesh = null;
    this.record = null;
  }

  /** Grows the columns to hold at least `n` particles and keeps their contents. @param {number} n */
  #reserve(n) {
    if (n <= this.radii.length) return;
    const room = Math.max(n, 2 * this.radii.length, 1024);
    this.positions = grown(this.positions, 3 * room);
    if (this.exact.length > 0) this.exact = grown(this.exact, 3 * room);
    this.normals = grown(this.normals, 3 * room);
    this.radii = grown(this.radii, room);
    this.levels = grown(this.levels, room);
    this.parents = grown(this.parents, room);
    this.slots = grown(this.slots, room);
  }

  /**
   * Adds rows to the counts of their levels. From row 0 on, the counts begin again.
   *
   * @param {number} first
   * @param {number} last
   */
  #count(first, last) {
    const { levels, parents, slots } = this;
    if (first === 0) {
      this.lastLevel = 0;
      this.tally = noTally();
    }
    for (let i = first; i < last; i += 1) if (levels[i] > this.lastLevel) this.lastLevel = levels[i];
    const { tally } = this;
    if (this.lastLevel >= tally.fresh.length) {
      const room = 2 * this.lastLevel + 1;
      tally.fresh = grown(tally.fresh, room);
      tally.seeds = grown(tally.seeds, room);
      tally.fates = grown(tally.fates, FATES * (room + 1));
    }
    const { fresh, seeds, fates } = tally;
    for (let i = first; i < last; i += 1) {
      const level = levels[i];
      // A particle on a crease or a smooth join has a row, with children, on each side.
      if (!this.isFurther(i)) {
        fresh[level] += 1;
        if (parents[i] === NO_PARENT) seeds[level] += 1;
      }
      for (let k = 0; k < MOST_SLOTS; k += 1) fates[FATES * (level + 1) + fateOf(slots[i], k)] += 1;
    }
  }

  /**
   * Writes a range. Ranges arrive in order, so `first` never exceeds the number of particles present.
   * @param {ColumnRange} range
   * @returns false, without writing, if the range does not follow the particles present
   */
  write(range) {
    const n = range.radii.length;
    const { first, total } = range;
    if (first > this.count || first + n > total || range.positions.length !== 3 * n || range.normals.length !== 3 * n)
      return false;
    // A relaxation moves the particles but keeps their levels and parents; then they need not be counted again.
    const known = this.count;
    const isSame =
      total >= known &&
      this.twins.length + (range.creases?.twins.length ?? 0) === 0 &&
      isRepeated(range, this, Math.min(n, known - first));
    this.#reserve(total);
    this.positions.set(range.positions, 3 * first);
    if (range.exact?.length) {
      if (this.exact.length === 0) this.exact = new Float64Array(this.positions.length);
      this.exact.set(range.exact, 3 * first);
    }
    this.normals.set(range.normals, 3 * first);
    this.radii.set(range.radii, first);
    this.levels.set(range.levels, first);
    this.parents.set(range.parents, first);
    this.slots.fill(0, Math.max(first, known), first + n);
    this.count = total;
    this.particles = range.progress?.particles ?? this.particles;
    if (range.creases) Object.assign(this, range.creases);
    this.#count(isSame ? known : 0, total);
    if (n > 0) this.forget();
    return true;
  }

  /**
   * Writes the principal curvatures of particles from `from` on. The curvatures before `from` must be known.
   * @param {number} from
   * @param {Float32Array} values
   */
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
   * Writes the figures of the report, one value per particle. Figures for another number of particles are ignored.
   * @param {Figures} figures
   */
  writeFigures(figures) {
    if (figures.valence.length !== this.count) return;
    const known = MEASURED.filter((name) => figures[name].length === this.count);
    Object.assign(this, Object.fromEntries(known.map((name) => [name, figures[name]])));
  }

  /**
   * Writes the colours that the surface has, by the names of their columns.
   * @param {Record<string, Float32Array>} own
   */
  writeOwn(own) {
    const known = Object.entries(own).filter(([, values]) => values.length === this.count);
    this.own = Object.fromEntries(known);
  }

  /** Writes a value per particle; values for another number of them are ignored. @param {Float32Array} values */
  writeValue(values) {
    this.value = values.length === this.count ? values : null;
  }

  /** Writes newer slot fates of particles from `from` on. @param {number} from @param {Uint32Array} slots */
  writeSlots(from, slots) {
    if (from + slots.length > this.count) return;
    const { fates } = this.tally;
    for (let i = 0; i < slots.length; i += 1) {
      const [before, now] = [this.slots[from + i], slots[i]];
      if (before === now) continue;
      const base = FATES * (this.levels[from + i] + 1);
      for (let k = 0; k < MOST_SLOTS; k += 1) {
        const fate = fateOf(now, k);
        fates[base + fateOf(before, k)] -= 1;
        fates[base + fate] += 1;
        if (fate === FATE.outside) this.isOpen = true;
      }
    }
    this.slots.set(slots, from);
  }

  /**
   * Returns the smallest box around the discs of all particles, or null if there are none.
   * @returns {Bounds | null}
   */
  bounds() {
    if (this.count === 0) return null;
    const min = vec(() => Infinity);
    const max = vec(() => -Infinity);
    for (let i = 0; i < this.count; i += 1) {
      const r = this.radii[i];
      for (let k = 0; k < 3; k += 1) {
        const v = this.positions[3 * i + k];
        if (v - r < min[k]) min[k] = v - r;
        if (v + r > max[k]) max[k] = v + r;
      }
    }
    return { min, max };
  }

  /** Removes the loose chips from the mesh. */
  leaveOutChips() {
    if (this.mesh) this.mesh = withoutChips(this.mesh);
  }
}

/**
 * Returns the counts of no particles. Per level there are the particles, the seeds among them, and the slots of the
 * level before by fate; one further level has the fates of the last level's slots.
 */
const noTally = () => ({ fresh: new Uint32Array(0), seeds: new Uint32Array(0), fates: new Uint32Array(0) });

/**
 * Whether the first `n` rows of a range have the same levels and parents as the rows that they replace.
 * @param {ColumnRange} range @param {Columns} columns @param {number} n
 */
function isRepeated({ first, levels, parents }, columns, n) {
  for (let i = 0; i < n; i += 1)
    if (levels[i] !== columns.levels[first + i] || parents[i] !== columns.parents[first + i]) return false;
  return true;
}

/**
 * Returns an empty column of the same kind.
 * @template {Float32Array | Float64Array | Uint32Array} T
 * @param {T} column @param {number} length
 */
export const emptyLike = (column, length) => /** @type {T} */ (new /** @type {any} */ (column.constructor)(length));

/**
 * Returns a longer column with the same values at its beginning.
 * @template {Float32Array | Float64Array | Uint32Array} T
 * @param {T} column @param {number} length
 */
export function grown(column, length) {
  const next = emptyLike(column, length);
  next.set(column);
  return next;
}

/** Returns a mesh without its loose chips. @param {Mesh} mesh @returns {Mesh} */
export function withoutChips({ triangles, about }) {
  const kept = new Uint32Array(triangles.length - 3 * about.chips.length);
  let [from, to] = [0, 0];
  for (const chip of [...about.chips, triangles.length / 3]) {
    const part = triangles.subarray(from, 3 * chip);
    kept.set(part, to);
    to += part.length;
    from = 3 * (chip + 1);
  }
  // Chips are the smallest bodies, and come last.
  const bodies = about.bodies.filter((body) => !body.is_chip);
  const components = about.components.filter(({ body }) => body < bodies.length);
  // If parts of a mesh touch, its volume is unknown, with or without chips. An open chip only hides the volume of the
  // others while it is there.
  const isOpen = about.components.some(({ open_edges }) => open_edges > 0);
  const isUnknown = (about.volume === null && !isOpen) || bodies.some(({ volume }) => volume === null);
  const volume = isUnknown ? null : bodies.reduce((sum, one) => sum + Number(one.volume), 0);
  // Borders begin with the holes that could not be filled.
  const rows = new Set(kept);
  const isKept = (/** @type {number[]} */ [row]) => rows.has(row);
  const loops = about.loops.filter(isKept);
  const unfilled = about.loops.slice(0, about.unfilled).filter(isKept).length;
  return {
    triangles: kept,
    about: { ...about, triangles: kept.length / 3, bodies, components, volume, loops, unfilled, chips: [] },
    leavesOutChips: true,
  };
}
