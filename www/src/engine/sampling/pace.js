/**
 * What runs cost, learnt from those that ended, and how the drag of a control goes.
 *
 * @module
 */
import { CostModel, costKey, planLive, sizeOf } from './scheduler.js';

/**
 * @typedef {import('../types.js').Seconds} Seconds
 * @typedef {import('../types.js').Settings} Settings
 * @typedef {import('../types.js').Timing} Timing
 * @typedef {import('./run-state.js').Run} Run
 * @typedef {import('./run-state.js').SampleRequest} SampleRequest
 */
/** What is learnt from a run. @typedef {{seconds: Seconds, particles: number, relax_steps: number, size: number}} Outcome */

/** After so long without a request the next one begins another drag. */
const NEXT_DRAG_MS = 1000;

export class Pace {
  /** @param {() => number} nowMs */
  constructor(nowMs) {
    this.nowMs = nowMs;
    /** What runs cost, by {@link costKey}. @type {Map<string, CostModel>} */
    this.costs = new Map();
    /** @type {{requested: number, latencies: number[], coarse: boolean, quietMs: number} | null} */
    this.drag = null;
  }

  /** @param {Pick<SampleRequest, 'field' | 'settings'>} request */
  costOf({ field, settings }) {
    const key = costKey(field, settings);
    const cost = this.costs.get(key) ?? new CostModel();
    this.costs.set(key, cost);
    return cost;
  }

  /** Settings for a run while a control is dragged. @param {SampleRequest} request @param {number} diagonal  of the clip box */
  plan(request, diagonal) {
    const now = this.nowMs();
    if (!this.drag || now - this.drag.quietMs > NEXT_DRAG_MS)
      this.drag = { requested: 0, latencies: [], coarse: false, quietMs: now };
    const { drag } = this;
    drag.requested += 1;
    drag.quietMs = now;
    const plan = planLive(request.settings, diagonal, this.costOf(request));
    drag.coarse ||= plan.coarse;
    return plan;
  }

  /**
   * Learns from a run what the next will cost.
   * @param {Run} run @param {SampleRequest} sampled  the sampling that it was, or went on with
   * @param {Outcome} outcome
   * @returns {import('../types.js').LastDrag | null} how the drag goes that the run belongs to
   */
  record({ request, sinceMs }, sampled, outcome) {
    const { particles } = outcome;
    const { drag } = this;
    const cost = this.costOf(sampled);
    if (request.kind === 'sample') cost.record(outcome);
    if (!request.live || !drag) return null;
    const latency = this.nowMs() - sinceMs;
    drag.latencies.push(latency);
    // What the sampler did not spend, drawing did: a slow graphics device holds up every message.
    cost.recordPicture(particles, latency - samplingSeconds(outcome.seconds) * 1e3);
    const sorted = [...drag.latencies].sort((a, b) => a - b);
    return {
      requested: drag.requested,
      shown: sorted.length,
      latency_ms: sorted[sorted.length >> 1],
      particles,
      coarse: drag.coarse,
    };
  }
}

/** Time for the particles alone, without the figures. @param {Seconds} seconds */
const samplingSeconds = ({ seeding, generation, relaxation }) => seeding + generation + relaxation;

/** Before the report is there. @param {Seconds} seconds @param {number} particles @param {boolean} live @returns {Timing} */
export function timingOf(seconds, particles, live) {
  const total = samplingSeconds(seconds);
  return { total, seconds, us_per_particle: particles > 0 ? (total * 1e6) / particles : 0, particles, live };
}

/** With the report. @param {{seconds: Seconds, count: number}} report @returns {Timing} */
export function timingOfReport({ seconds, count }) {
  const total = samplingSeconds(seconds) + seconds.quality;
  const usPerParticle = ((total - seconds.quality) * 1e6) / Math.max(1, count);
  return { total, seconds, us_per_particle: usPerParticle, particles: count, live: false };
}

/**
 * The size by which the cost of a run is known, NaN where it is not. A uniform run tells its radius also where the count decides.
 * @param {Settings} settings @param {number} radius @param {import('../types.js').Bounds | undefined} bounds
 */
export function sizeOfRun(settings, radius, bounds) {
  if (settings.sampling !== 'adaptive') return radius;
  return bounds ? sizeOf(settings, Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k]))) : NaN;
}
