/**
 * Queues the jobs of a worker: one runs, and the latest one waits. A job replaces the running one only after the core
 * has accepted its field. A refused field changes nothing in the core, so the running job continues and the surface
 * that stays on the page is completed and measured.
 *
 * @module
 */

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FieldAnswer } from '../types.js'
 * @import { FromWorker, Job, SampleJob, ToWorker } from './types.js'
 */

/** A job that has not started. @typedef {{job: Job, stopped: boolean}} Pending */

/**
 * Sets the field of a job in the core. A model is passed again for every job: it has a few kilobytes, and tracking
 * which model the core holds would cost more.
 * @param {Core} core @param {SampleJob} job
 * @returns {FieldAnswer}
 */
function setField(core, { field, points }) {
  if (!points) return core.set_field(field);
  return core.set_points(points.field, points.info, field);
}

/**
 * Measures particles that something else has placed. The core takes their field, so it must be one that samples
 * nothing.
 * @param {Core} core @param {Extract<ToWorker, {type: 'measure'}>} question
 * @returns {FromWorker}
 */
export function measured(core, { request, field, placed: { positions, normals, radii }, isAdaptive }) {
  const answer = core.set_field(field);
  if (!answer.ok) return { type: 'measured', request, error: answer.error };
  const measures = core.measure_placed(positions, normals, radii, isAdaptive);
  return { type: 'measured', request, measures: { ...measures, energy: core.energy(), valence: core.valence() } };
}

export class Jobs {
  #post;

  /** The latest job; its field has not been passed to the core. @type {Pending | null} */
  #waiting;

  /**
   * The job whose field the core has accepted. It runs as soon as the running job has ended.
   * @type {Pending | null}
   */
  #accepted;

  /** Whether it must stop. */
  #stopped;

  /** @param {(message: FromWorker) => void} post */
  constructor(post) {
    this.#post = post;
    this.#waiting = null;
    this.#accepted = null;
    /** The job that runs. @type {Job | null} */
    this.running = null;
    this.#stopped = false;
  }

  /** @param {Job} job */
  add(job) {
    this.#waiting = { job, stopped: false };
  }

  /** Stops all jobs added so far. */
  stop() {
    this.#stopped = true;
    if (this.#waiting) this.#waiting.stopped = true;
    if (this.#accepted) this.#accepted.stopped = true;
  }

  /** Begins and returns the next job, with its field set in the core. @param {Core} core */
  take(core) {
    this.#ask(core);
    const next = this.#accepted;
    this.#accepted = null;
    this.#stopped = next?.stopped ?? false;
    this.running = next?.job ?? null;
    return this.running;
  }

  /**
   * Returns what the running job must do. The job calls this between two steps.
   * @param {Core} core
   */
  interrupt(core) {
    this.#ask(core);
    if (this.#accepted) return 'replace';
    return this.#stopped ? 'stop' : null;
  }

  /** @param {Core} core */
  #ask(core) {
    const next = this.#waiting;
    if (!next) return;
    const { job } = next;
    this.#waiting = null;
    if (job.kind === 'sample') {
      const answer = setField(core, job);
      this.#post({ type: 'field', id: job.id, answer });
      if (!answer.ok) return;
    }
    this.#accepted = next;
  }
}
