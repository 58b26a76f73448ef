/**
 * The jobs of a worker: one under way, one that waits, always the latest. A job takes over only once the core has accepted its
 * field. A refused one changes nothing in the core, so that what is under way, run or measurement, goes on to its end and the
 * surface that stays on the page is whole and has its own report.
 *
 * @module
 */

/**
 * @typedef {import('./protocol.js').Job} Job
 * @typedef {import('./protocol.js').FromWorker} FromWorker
 * @typedef {import('./job.js').CoreLike} CoreLike
 */
/** A job that has not begun. @typedef {{job: Job, stopped: boolean}} Pending */

/**
 * A model is set anew for every job: its few kilobytes cost less than to know which one the core of this worker has.
 * @param {CoreLike} core @param {import('./protocol.js').SampleJob} job
 * @returns {import('../types.js').FieldAnswer}
 */
function setField(core, { field, points }) {
  if (!points) return core.set_field(field);
  const { info, bounds } = points.info;
  return core.set_points(points.field, { info, bounds: field.bounds ?? bounds });
}

export class Jobs {
  /** @param {(message: FromWorker) => void} post */
  constructor(post) {
    this.post = post;
    /** The core has not been asked about it. @type {Pending | null} */
    this.waiting = null;
    /** Its field is the core's: it runs as soon as the one under way has given way. @type {Pending | null} */
    this.accepted = null;
    /** The one under way is to end. */
    this.stopped = false;
  }

  /** @param {Job} job */
  add(job) {
    this.waiting = { job, stopped: false };
  }

  /** Ends what was added before. */
  stop() {
    this.stopped = true;
    if (this.waiting) this.waiting.stopped = true;
    if (this.accepted) this.accepted.stopped = true;
  }

  /** The job to run next, its field set. @param {CoreLike} core @returns {Job | null} */
  take(core) {
    this.ask(core);
    const next = this.accepted;
    this.accepted = null;
    this.stopped = next?.stopped ?? false;
    return next?.job ?? null;
  }

  /** What a job under way has to do: between two steps it asks. @param {CoreLike} core @returns {'stop' | 'replace' | null} */
  interrupt(core) {
    this.ask(core);
    if (this.accepted) return 'replace';
    return this.stopped ? 'stop' : null;
  }

  /** @param {CoreLike} core */
  ask(core) {
    const next = this.waiting;
    if (!next) return;
    const { job } = next;
    this.waiting = null;
    if (job.kind === 'sample') {
      const answer = setField(core, job);
      this.post({ type: 'field', id: job.id, answer });
      if (!answer.ok) return;
    }
    this.accepted = next;
  }
}
