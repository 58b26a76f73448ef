/**
 * The cost of runs on this machine, learnt from earlier ones: how many particles a run may have during a drag, and what
 * the latency of the drag was.
 *
 * @module
 */

/** @import { Bounds, LastDrag, Seconds, Settings, Timing } from '../types.js' */
/** @import { SampleJob } from './types.js' */

/** Largest latency at which the picture still seems to follow a slider. */
export const LIVE_MS = 60;
/** Relaxation steps of a coarse run: enough to even out the seams, at about a third of the cost. */
const COARSE_RELAX_STEPS = 3;
/** Latency of two screen frames, which does not count as drawing time. */
const FRAME_MS = 34;
/** Fewest particles that still show the shape of a surface. */
const FEWEST = 500;

/**
 * Returns a key that groups runs of one pace. Points and formulas differ by an order of magnitude; so do adaptive and
 * uniform runs, and the two methods. Each radius law relates the number of particles to a different length.
 * @param {Pick<SampleJob, 'field' | 'settings'>} job
 */
export const paceKey = ({ field, settings }) =>
  [
    field.points === undefined ? 'formula' : 'points',
    settings.sampling,
    settings.sampling === 'adaptive' ? settings.radius_law : '',
    settings.method === 'refined' ? 'refined' : '',
  ].join(' ');

/**
 * Returns the length whose square is inversely proportional to the number of particles: the radius, or the length that
 * scales all radii of an adaptive run. NaN if the settings give a count.
 * @param {Settings} settings @param {number} diagonal  of the clip box
 */
export function sizeOf(settings, diagonal) {
  if (settings.size_mode === 'count') return NaN;
  if (settings.sampling !== 'adaptive') return Number(settings.radius_share) * diagonal;
  // h = √(6εR − 3ε²) ≈ √(6εR): the chord error ε is a share of the diagonal.
  return settings.radius_law === 'chord_error'
    ? Math.sqrt(Number(settings.chord_error) * diagonal)
    : Number(settings.curvature_scale);
}

/**
 * Estimates the cost of a run on this machine from earlier runs of one {@link paceKey}: milliseconds for seeding,
 * microseconds per particle for the front, a relaxation step and drawing, and the number of particles for a size on the
 * current surface.
 */
export class Pace {
  #frontUs;
  #relaxUs;

  constructor() {
    // Initial values are those of a slow laptop, until a run has been measured.
    this.fixedMs = 5;
    this.#frontUs = 1.5;
    this.#relaxUs = 0.25;
    /** Drawing time per particle; zero if the graphics card keeps up with the screen. */
    this.drawUs = 0;
    /** count · size², nearly constant for a surface; 0 while unknown. */
    this.area = 0;
    this.known = false;
  }

  /**
   * @param {{seconds: Seconds, particles: number, relax_steps: number, size: number}} run  `size` from {@link sizeOf},
   *   NaN if unknown
   */
  record({ seconds, particles, relax_steps, size }) {
    if (particles < 1) return;
    if (size > 0) this.area = particles * size * size;
    const share = this.known ? 0.5 : 1;
    const blend = (/** @type {number} */ old, /** @type {number} */ now) => old + share * (now - old);
    this.fixedMs = blend(this.fixedMs, seconds.seeding * 1e3);
    this.#frontUs = blend(this.#frontUs, ((seconds.generation + seconds.refinement) * 1e6) / particles);
    if (relax_steps > 0) this.#relaxUs = blend(this.#relaxUs, (seconds.relaxation * 1e6) / (particles * relax_steps));
    this.known = true;
  }

  /**
   * Records how much longer a live run took than its sampling.
   * @param {number} particles
   * @param {number} waitedMs
   */
  recordPicture(particles, waitedMs) {
    if (particles < FEWEST) return;
    this.drawUs += 0.3 * ((Math.max(0, waitedMs - FRAME_MS) * 1e3) / particles - this.drawUs);
  }

  /** @param {number} particles @param {number} relaxSteps */
  milliseconds(particles, relaxSteps) {
    return this.fixedMs + (particles * this.perParticle(relaxSteps)) / 1e3;
  }

  /** Returns the microseconds per particle. @param {number} relaxSteps */
  perParticle(relaxSteps) {
    return this.#frontUs + relaxSteps * this.#relaxUs + this.drawUs;
  }

  /** Returns the expected number of particles. @param {Settings} settings @param {number} diagonal */
  expected(settings, diagonal) {
    const cap = Number(settings.max_particles);
    const n = settings.size_mode === 'count' ? Number(settings.count) : this.area / sizeOf(settings, diagonal) ** 2;
    return Math.min(n, cap);
  }

  /**
   * Returns the settings of a run during a drag: the full ones if they take at most {@link LIVE_MS}, else settings for
   * the affordable number of particles. The caller limits them to their ranges. A refined run keeps its settings, since
   * it can end at its coarse level, from which the full run continues.
   * @param {Settings} settings  complete, with the defaults filled in
   * @param {number} diagonal  of the clip box; the radius is a share of it
   * @returns {{settings: Settings, coarse: boolean}}
   */
  plan(settings, diagonal) {
    const relaxSteps = Number(settings.relax_steps);
    const expected = this.expected(settings, diagonal);
    if (!this.known || !(expected > 0) || !(diagonal > 0) || this.milliseconds(expected, relaxSteps) <= LIVE_MS)
      return { settings, coarse: false };
    if (settings.method === 'refined') return { settings, coarse: true };
    const coarseRelax = Math.min(relaxSteps, COARSE_RELAX_STEPS);
    const perParticleMs = this.perParticle(coarseRelax) / 1e3;
    // If seeding takes most of the time, fewer particles do not help; they get half of it.
    const affordable = Math.max(FEWEST, Math.max(LIVE_MS - this.fixedMs, LIVE_MS / 2) / perParticleMs);
    const particles = Math.min(expected, affordable);
    const size = coarser(settings, diagonal, this.area, particles, expected / particles);
    return { settings: { ...settings, relax_steps: coarseRelax, ...size }, coarse: true };
  }
}

/**
 * Returns the size settings for a number of particles, `fewer` times smaller than the current one.
 * @param {Settings} settings
 * @param {number} diagonal
 * @param {number} area  particles · size², 0 while unknown
 * @param {number} particles
 * @param {number} fewer
 * @returns {Settings}
 */
function coarser(settings, diagonal, area, particles, fewer) {
  if (settings.sampling !== 'adaptive') {
    // A radius avoids the pilot run that a count requires.
    if (area > 0) return { size_mode: 'radius', radius_share: Math.sqrt(area / particles) / diagonal };
    return { count: Math.round(particles) };
  }
  if (settings.size_mode === 'count') return { count: Math.round(particles) };
  const factor = Math.sqrt(fewer);
  return {
    chord_error: Number(settings.chord_error) * fewer,
    curvature_scale: Number(settings.curvature_scale) * factor,
    radius_min_share: Number(settings.radius_min_share) * factor,
    radius_max_share: Number(settings.radius_max_share) * factor,
  };
}

/** Pause between live requests after which the next one counts as another drag. */
const NEXT_DRAG_MS = 1000;

/** Measures one drag of a control. */
export class Drag {
  /** @type {number[]} */
  #latencies = [];
  #requested = 0;
  #coarse = false;

  /** @param {number} nowMs */
  constructor(nowMs) {
    /** When its last run was requested. */
    this.sinceMs = nowMs;
  }

  /** Records a request. Returns its drag: this one, or the next. @param {number} nowMs @returns {Drag} */
  requested(nowMs) {
    if (nowMs - this.sinceMs > NEXT_DRAG_MS) return new Drag(nowMs).requested(nowMs);
    this.sinceMs = nowMs;
    this.#requested += 1;
    return this;
  }

  /**
   * Records a run of the drag that has ended.
   * @param {number} latencyMs @param {number} particles @param {boolean} coarse
   * @returns {LastDrag}
   */
  shown(latencyMs, particles, coarse) {
    this.#latencies.push(latencyMs);
    this.#coarse ||= coarse;
    const sorted = [...this.#latencies].sort((a, b) => a - b);
    return {
      requested: this.#requested,
      shown: sorted.length,
      latency_ms: sorted[sorted.length >> 1],
      particles,
      coarse: this.#coarse,
    };
  }
}

/** Returns the sampling time, without the measurement of the figures. @param {Seconds} seconds */
export const samplingSeconds = ({ seeding, generation, refinement, relaxation }) =>
  seeding + generation + refinement + relaxation;

/**
 * Returns the timing of a run.
 * @param {Seconds} seconds @param {number} particles
 * @param {number} steps  those of a relaxation alone, else 0
 * @returns {Timing}
 */
export const timingOf = (seconds, particles, steps) => ({
  steps,
  sampling: samplingSeconds(seconds),
  seconds,
  particles,
});

/**
 * Returns the length that determines the cost of a run (see {@link sizeOf}), or NaN if it is unknown. A uniform run
 * with a count reports the radius that it found.
 * @param {Settings} settings @param {number} radius @param {Bounds | undefined} bounds
 */
export function sizeOfRun(settings, radius, bounds) {
  if (settings.sampling !== 'adaptive') return radius;
  return bounds ? sizeOf(settings, Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k]))) : NaN;
}
