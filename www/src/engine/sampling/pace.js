/**
 * Measures the cost of finished runs and the latency of a drag.
 *
 * @module
 */
import { CostModel, costKey, planLive, sizeOf } from './cost.js';
import { KINDS } from './kinds.js';

/**
 * @import { Bounds, LastDrag, Seconds, Settings, Timing } from '../types.js'
 * @import { Measured, SampleRequest, Ticket } from './types.js'
 */

/** Pause between live requests after which the next one counts as another drag. */
const NEXT_DRAG_MS = 1000;

export class Pace {
  #nowMs;

  /** Cost models by {@link costKey}. @type {Map<string, CostModel>} */
  #costs;

  /** @param {() => number} nowMs */
  constructor(nowMs) {
    this.#nowMs = nowMs;
    this.#costs = new Map();
    /** @type {{requested: number, latencies: number[], coarse: boolean, quietMs: number} | null} */
    this.drag = null;
  }

  /** @param {Pick<SampleRequest, 'field' | 'settings'>} request */
  #costOf({ field, settings }) {
    const key = costKey(field, settings);
    const cost = this.#costs.get(key) ?? new CostModel();
    this.#costs.set(key, cost);
    return cost;
  }

  /**
   * Returns the settings of a run during a drag.
   * @param {SampleRequest} request
   * @param {number} diagonal  of the clip box
   */
  plan(request, diagonal) {
    const now = this.#nowMs();
    if (!this.drag || now - this.drag.quietMs > NEXT_DRAG_MS)
      this.drag = { requested: 0, latencies: [], coarse: false, quietMs: now };
    const { drag } = this;
    drag.requested += 1;
    drag.quietMs = now;
    return planLive(request.settings, diagonal, this.#costOf(request));
  }

  /**
   * Updates the cost model and the drag from a finished run.
   * @param {Ticket} run @param {SampleRequest} sampled  the request that the run sampled, or whose particles it relaxed
   * @param {Measured} measured
   * @returns {LastDrag | null} the state of the drag that the run belongs to, if any
   */
  record({ request, sinceMs }, sampled, measured) {
    const { particles } = measured;
    const { drag } = this;
    const cost = this.#costOf(sampled);
    // A run that ended at its coarse level, or whose particles followed, does not tell the cost of a whole run.
    const isWhole = !measured.followed && !(request.kind === 'sketch' && request.settings.method === 'refined');
    if (request.kind !== 'relax' && isWhole) cost.record(measured);
    if (!KINDS[request.kind].isLive || !drag) return null;
    const latency = this.#nowMs() - sinceMs;
    drag.latencies.push(latency);
    drag.coarse ||= request.kind === 'sketch' && !measured.followed;
    // The rest of the latency is drawing: a slow graphics device delays every message.
    cost.recordPicture(particles, latency - samplingSeconds(measured.seconds) * 1e3);
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

/** Returns the sampling time, without the measurement of the figures. @param {Seconds} seconds */
const samplingSeconds = ({ seeding, generation, refinement, relaxation }) =>
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
