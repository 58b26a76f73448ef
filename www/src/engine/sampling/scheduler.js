/**
 * Which job runs next, and how fine it may be while a control is dragged.
 *
 * @module
 */

/**
 * @typedef {import('../types.js').Seconds} Seconds
 * @typedef {import('../types.js').Settings} Settings
 */

/** A picture that is this late no longer feels attached to the slider. */
export const LIVE_MS = 60;
/** A live job that takes longer than this gives way to the newest values; a shorter one is let finish, or none ever would. */
const PATIENCE_MS = 150;
/** Relaxation steps of a coarse run: enough to mend the seams, a third of the price. */
const COARSE_RELAX_STEPS = 3;
/** Waiting for the screen's next frame and the one after it is nobody's fault. */
const FRAME_MS = 34;
/** Below this a surface can no longer be made out. */
const FEWEST = 500;

/**
 * Latest wins: at most one job at the worker and one waiting, whatever the rate of requests.
 * @template {{live: boolean}} T
 */
export class Scheduler {
  /** @param {(id: number, request: T) => void} dispatch @param {() => number} nowMs */
  constructor(dispatch, nowMs = () => performance.now()) {
    this.dispatch = dispatch;
    this.nowMs = nowMs;
    this.lastId = 0;
    /** @type {{id: number, request: T, sinceMs: number} | null} */
    this.running = null;
    /** @type {T | null} */
    this.waiting = null;
  }

  /** @param {T} request */
  submit(request) {
    const { running } = this;
    if (running?.request.live && request.live && this.nowMs() - running.sinceMs < PATIENCE_MS) {
      this.waiting = request;
      return;
    }
    this.waiting = null;
    this.send(request);
  }

  /** @param {T} request */
  send(request) {
    this.lastId += 1;
    this.running = { id: this.lastId, request, sinceMs: this.nowMs() };
    this.dispatch(this.lastId, request);
  }

  /**
   * The worker is done with a job.
   * @param {number} id
   * @param {Scheduler<T>['running']} [before]  the job that goes on, where this one's field was refused
   * @returns {boolean} false for a job that is no longer the present one
   */
  ended(id, before = null) {
    if (this.running?.id !== id) return false;
    this.running = before;
    const { waiting } = this;
    this.waiting = null;
    if (waiting) this.send(waiting);
    return true;
  }

  /** Forgets everything; the worker is gone. @returns {T | null} what it was at, or was to do next */
  drop() {
    const lost = this.waiting ?? this.running?.request ?? null;
    this.running = null;
    this.waiting = null;
    return lost;
  }
}

/**
 * Runs whose costs are alike: points and formulas differ by an order of magnitude, and so do adaptive and uniform runs; the
 * number of particles follows from another length for every law.
 * @param {import('../types.js').FieldRequest} field @param {Settings} settings
 */
export const costKey = (field, settings) =>
  [
    field.points === undefined ? 'formula' : 'points',
    settings.sampling,
    settings.sampling === 'adaptive' ? settings.radius_law : '',
  ].join(' ');

/**
 * The quantity to whose square the number of particles is inversely proportional: the radius, or what every radius of an
 * adaptive run is proportional to. NaN where the count decides.
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
 * What a run costs on this machine, from the runs before: milliseconds to find the surface, microseconds per particle for the
 * front, for a relaxation step and for drawing, and the particles that a size gives on the present surface.
 */
export class CostModel {
  constructor() {
    // A slow laptop's figures, until the first run tells.
    this.fixedMs = 5;
    this.frontUs = 1.5;
    this.relaxUs = 0.25;
    /** Zero wherever the graphics card keeps up with the screen. */
    this.drawUs = 0;
    /** count · size², nearly constant for one surface; 0 until known. */
    this.area = 0;
    this.known = false;
  }

  /** @param {{seconds: Seconds, particles: number, relax_steps: number, size: number}} run  `size` as of {@link sizeOf}, NaN where unknown */
  record({ seconds, particles, relax_steps, size }) {
    if (particles < 1) return;
    if (size > 0) this.area = particles * size * size;
    const share = this.known ? 0.5 : 1;
    const blend = (/** @type {number} */ old, /** @type {number} */ now) => old + share * (now - old);
    this.fixedMs = blend(this.fixedMs, seconds.seeding * 1e3);
    this.frontUs = blend(this.frontUs, (seconds.generation * 1e6) / particles);
    if (relax_steps > 0) this.relaxUs = blend(this.relaxUs, (seconds.relaxation * 1e6) / (particles * relax_steps));
    this.known = true;
  }

  /** A live run of so many particles took this much longer than its sampling. @param {number} particles @param {number} waitedMs */
  recordPicture(particles, waitedMs) {
    if (particles < FEWEST) return;
    this.drawUs += 0.3 * ((Math.max(0, waitedMs - FRAME_MS) * 1e3) / particles - this.drawUs);
  }

  /** @param {number} particles @param {number} relaxSteps */
  milliseconds(particles, relaxSteps) {
    return this.fixedMs + (particles * this.perParticle(relaxSteps)) / 1e3;
  }

  /** Microseconds. @param {number} relaxSteps */
  perParticle(relaxSteps) {
    return this.frontUs + relaxSteps * this.relaxUs + this.drawUs;
  }

  /** Particles to expect. @param {Settings} settings @param {number} diagonal */
  expected(settings, diagonal) {
    const cap = Number(settings.max_particles);
    const n = settings.size_mode === 'count' ? Number(settings.count) : this.area / sizeOf(settings, diagonal) ** 2;
    return Math.min(n, cap);
  }
}

/**
 * Settings for a run while a control is dragged: the full ones if they fit {@link LIVE_MS}, else as many particles as do. The
 * caller brings them into their ranges.
 * @param {Settings} settings  complete, with the defaults filled in
 * @param {number} diagonal  of the clip box, of which the radius is a share
 * @param {CostModel} cost
 * @param {number} [budgetMs]
 * @returns {{settings: Settings, coarse: boolean}}
 */
export function planLive(settings, diagonal, cost, budgetMs = LIVE_MS) {
  const relaxSteps = Number(settings.relax_steps);
  const expected = cost.expected(settings, diagonal);
  if (!cost.known || !(expected > 0) || !(diagonal > 0) || cost.milliseconds(expected, relaxSteps) <= budgetMs)
    return { settings, coarse: false };
  const coarseRelax = Math.min(relaxSteps, COARSE_RELAX_STEPS);
  const perParticleMs = cost.perParticle(coarseRelax) / 1e3;
  // Where finding the surface alone takes the time, fewer particles would not help: they keep half the budget.
  const affordable = Math.max(FEWEST, Math.max(budgetMs - cost.fixedMs, budgetMs / 2) / perParticleMs);
  const particles = Math.min(expected, affordable);
  return {
    settings: {
      ...settings,
      relax_steps: coarseRelax,
      ...coarser(settings, diagonal, cost, particles, expected / particles),
    },
    coarse: true,
  };
}

/**
 * The settings of size for so many particles, `fewer` times fewer than now.
 * @param {Settings} settings @param {number} diagonal @param {CostModel} cost @param {number} particles @param {number} fewer
 * @returns {Settings}
 */
function coarser(settings, diagonal, cost, particles, fewer) {
  if (settings.sampling !== 'adaptive') {
    // A radius needs no trial run, as a count does.
    if (cost.area > 0) return { size_mode: 'radius', radius_share: Math.sqrt(cost.area / particles) / diagonal };
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
