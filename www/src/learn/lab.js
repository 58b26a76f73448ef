/**
 * Runs the paper's algorithms for the figures. Each run has its own worker while its events may still be requested; a
 * run that is only shown keeps its particles and frees the worker.
 */
import { RESIDUAL } from '../figures/particle.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { Meter } from '../engine/sampling/meter.js'
 * @import { LessonClient, LessonParticles } from '../engine/types.js'
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { LabRun } from './types.js'
 */

/** Particles in the figures: enough for rings, few enough to tell them apart. */
export const PARTICLES = 1500;
/** Particles in figures of single particles; the surface then bends much within 2r. */
const COARSE_PARTICLES = 180;
/** Number of seeds tried to find one with six children. */
const SEED_TRIALS = 6;
const SLOTS = 6;
/** Radius of the first trial, as a share of the box's diagonal. */
const TRIAL = 1 / 30;
/** Relative difference within which a count is accepted. */
const CLOSE = 0.12;
/** Relative difference within which two counts are equal. */
const ALIKE = 0.004;
const MOST_TRIALS = 4;

/**
 * The usual settings of the figures: Algorithm 2 child by child, and ten relaxation steps.
 * @type {Partial<LessonSettings>}
 */
export const USUAL = { placing: 'one_by_one', matched: 'stay', gaps: 'leave', relax_steps: 10, residual: RESIDUAL };

/** The surface has no particles for the figures. */
export class NoSurface extends Error {}

export class Lab {
  #open;
  #meter;

  /** @type {WeakMap<LessonParticles, ReturnType<Meter['measure']>>} */
  #measures = new WeakMap();

  /** @type {Map<string, Lab>} */
  #others = new Map();

  /** @type {Map<string, Promise<LabRun>>} */
  #runs;

  /** @type {Map<number, Promise<number>>} */
  #radii;

  /**
   * Runs follow one another, so that a page of figures keeps only one processor busy.
   * @type {Promise<unknown>}
   */
  #last;

  /** @param {FormulaSurface} surface @param {() => Promise<LessonClient>} open @param {Meter} meter */
  constructor(surface, open, meter) {
    this.surface = surface;
    this.#open = open;
    this.#meter = meter;
    this.#runs = new Map();
    this.#radii = new Map();
    this.#last = Promise.resolve();
  }

  /** The surfaces of the gallery. */
  gallery() {
    return this.#meter.surfaces();
  }

  /** A new lab on another surface. @param {FormulaSurface} surface */
  beside(surface) {
    return new Lab(surface, this.#open, this.#meter);
  }

  /** The lab on another surface, which makes each run once. @param {FormulaSurface} surface */
  on(surface) {
    const key = JSON.stringify(surface);
    const known = this.#others.get(key) ?? this.beside(surface);
    this.#others.set(key, known);
    return known;
  }

  /**
   * A run with as many particles as another run, although its particles keep a different distance with the same radius:
   * the radius is scaled until the counts agree.
   * @param {Partial<LessonSettings>} change @param {LabRun} other
   */
  async runAsMany(change, other) {
    let radius = other.radius;
    for (let trial = 0; ; trial += 1) {
      const run = await this.run({ ...change, radius });
      const ratio = run.end.radii.length / other.end.radii.length;
      if (Math.abs(ratio - 1) < ALIKE || trial === MOST_TRIALS) return run;
      radius *= Math.sqrt(ratio);
    }
  }

  /** @template T @param {() => Promise<T>} job */
  #queued(job) {
    const done = this.#last.then(job, job);
    this.#last = done.catch(() => {});
    return done;
  }

  /**
   * The radius with which the surface has about this number of particles.
   * @param {number} particles
   */
  radiusFor(particles) {
    const known = this.#radii.get(particles);
    if (known) return known;
    const found = this.#queued(() => this.#searchRadius(particles));
    this.#radii.set(particles, found);
    found.catch(() => this.#radii.delete(particles));
    return found;
  }

  /** @param {number} particles */
  async #searchRadius(particles) {
    const { min, max } = this.surface.bounds;
    const client = await this.#open();
    let radius = TRIAL * Math.hypot(...max.map((m, k) => m - min[k]));
    try {
      for (let trial = 0; trial < MOST_TRIALS; trial += 1) {
        const settings = { ...USUAL, relax_steps: 0, radius, max_particles: 4 * particles };
        const { particles: count } = await client.start(this.surface, settings);
        if (count === 0 && trial > 0) throw new NoSurface('The formula has no surface in its box.');
        if (Math.abs(count / particles - 1) < CLOSE) break;
        // No particles: the trial was too coarse, or there is no surface.
        radius *= count === 0 ? 0.25 : Math.sqrt(count / particles);
      }
    } finally {
      client.close();
    }
    return Number(radius.toPrecision(3));
  }

  /**
   * Measures particles as the sampler's report does. `isAdaptive`: each relative to its own size.
   * @param {LessonParticles} particles @param {boolean} isAdaptive
   */
  measure(particles, isAdaptive) {
    const { formula, parameters, bounds } = this.surface;
    const measures =
      this.#measures.get(particles) ??
      this.#meter.measure({ formula, declare: parameters, bounds }, particles, isAdaptive);
    this.#measures.set(particles, measures);
    measures.catch(() => this.#measures.delete(particles));
    return measures;
  }

  /**
   * Returns a run, made once for the same settings.
   * @param {Partial<LessonSettings>} change  of the usual settings
   * @param {{ particles?: number, keep?: boolean }} [how]  `particles`: their approximate number, unless a radius
   *   is given; `keep`: events will be requested
   * @returns {Promise<LabRun>}
   */
  async run(change, { particles = PARTICLES, keep = false } = {}) {
    const radius = change.radius ?? (await this.radiusFor(particles));
    const settings = { ...USUAL, ...change, radius };
    const key = JSON.stringify([settings, keep]);
    const known = this.#runs.get(key);
    if (known) return known;
    const made = this.#queued(() => this.#make(settings, radius, keep));
    this.#runs.set(key, made);
    made.catch(() => this.#runs.delete(key));
    return made;
  }

  /** Ends a run that was kept, and removes it. @param {LabRun} run */
  drop({ client, settings }) {
    client.close();
    this.#runs.delete(JSON.stringify([settings, true]));
  }

  /**
   * Returns a run with few, large particles and no relaxation. If possible its seed has six children; near the end of
   * the surface a seed has fewer.
   * @returns {Promise<LabRun>}
   */
  async coarse() {
    let run = null;
    for (let seed = 0; seed < SEED_TRIALS; seed += 1) {
      run = await this.run({ relax_steps: 0, seed }, { particles: COARSE_PARTICLES, keep: true });
      if (run.chapters[0]?.fates.added === SLOTS) return run;
    }
    return /** @type {LabRun} */ (run);
  }

  /**
   * @param {Partial<LessonSettings>} settings @param {number} radius @param {boolean} keep
   * @returns {Promise<LabRun>}
   */
  async #make(settings, radius, keep) {
    const client = await this.#open();
    try {
      const progress = await client.start(this.surface, settings);
      const chapters = await client.ask('chapters', { first: 0 });
      const front = chapters.filter(({ kind }) => kind !== 'relaxation');
      const rest = chapters[front.length];
      const placed = await client.ask('seek', { event: rest?.first_event ?? Infinity });
      const placing = front.at(-1)?.evaluations ?? 0;
      const end = await client.ask('seek', { event: Infinity });
      if (end.radii.length === 0) throw new NoSurface('The formula has no surface in its box.');
      return { lab: this, client, settings, radius, chapters, progress, placed, end, placing };
    } catch (error) {
      client.close();
      throw error;
    } finally {
      if (!keep) client.close();
    }
  }
}
