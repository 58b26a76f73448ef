/**
 * The one queue of jobs, in the worker: one runs, and the latest one waits. A job replaces the running one only after
 * the core has accepted its field. A refused field changes nothing in the core, so the running job continues and the
 * surface that stays on the page is completed and measured.
 *
 * @module
 */
import { KINDS } from './kinds.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FileKeeper } from '../files/keeper.js'
 * @import { KeyedFile } from '../files/types.js'
 * @import { FieldAnswer } from '../types.js'
 * @import { FromWorker, Job, SampleJob, ToWorker } from './types.js'
 */

/**
 * Time after which a live job is replaced by one with newer values. Until then it continues; otherwise no job would
 * finish. So does the run of a control that rests, since the particles that it leaves can follow the surface again.
 */
const PATIENCE_MS = 150;

/**
 * What opens files in the core. `isReady` opens the one of a job if need be, and has the worker ask again.
 * @typedef {{isReady: (core: Core, file: KeyedFile) => boolean, setField: FileKeeper['setField']}} Files
 */
/** Where no job is of a file. @type {Files} */
const NO_FILES = {
  isReady: () => true,
  setField: () => {
    throw new Error('there are no files here');
  },
};

/** A job that has not started. @typedef {{job: Job, stopped: boolean}} Pending */

/**
 * Sets the field of a job in the core. A model is passed again for every job: it has a few kilobytes, and tracking
 * which model the core holds would cost more.
 * @param {Core} core @param {SampleJob} job @param {Files} files
 * @returns {FieldAnswer}
 */
function setField(core, { field, points, file }, files) {
  if (file) return files.setField(core, file, field);
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
  #nowMs;
  #files;

  /** The latest job; its field has not been passed to the core. @type {Pending | null} */
  #waiting;

  /**
   * The job whose field the core has accepted. It runs as soon as the running job has ended.
   * @type {Pending | null}
   */
  #accepted;

  /** Whether the running job must stop. */
  #stopped;

  /** When it began, and whether all its particles are on their way to the page. */
  #running = { sinceMs: 0, isSampled: false };

  /** @param {(message: FromWorker) => void} post @param {() => number} nowMs @param {Files} [files] */
  constructor(post, nowMs, files = NO_FILES) {
    this.#post = post;
    this.#nowMs = nowMs;
    this.#files = files;
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

  /**
   * Stops all jobs added so far. A waiting one whose particles would follow those of the running one is dropped: on its
   * surface there are none yet, and the running one is to keep its field, to which its particles belong.
   */
  stop() {
    this.#stopped = true;
    const job = this.#waiting?.job;
    if (this.running && job && job.kind !== 'relax' && job.following.length > 0) {
      this.#post({ type: 'dropped', id: job.id });
      this.#waiting = null;
    }
    if (this.#waiting) this.#waiting.stopped = true;
    if (this.#accepted) this.#accepted.stopped = true;
  }

  /** Begins and returns the next job, with its field set in the core. @param {Core} core */
  take(core) {
    this.running = null;
    this.#ask(core);
    const next = this.#accepted;
    this.#accepted = null;
    this.#stopped = next?.stopped ?? false;
    this.running = next?.job ?? null;
    this.#running = { sinceMs: this.#nowMs(), isSampled: false };
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

  /** Notes that the running job has its particles: what is left is its report, for which no other waits. */
  sampled() {
    this.#running.isSampled = true;
  }

  /**
   * Whether a job waits until the running one has ended, which would otherwise be replaced time and again.
   * @param {Job} job
   */
  #isPatient({ kind }) {
    const { running } = this;
    if (!running || this.#running.isSampled || !KINDS[kind].isLive) return false;
    const isSpared = KINDS[running.kind].isLive || running.kind === 'rest';
    return isSpared === true && this.#nowMs() - this.#running.sinceMs < PATIENCE_MS;
  }

  /** @param {Core} core */
  #ask(core) {
    const next = this.#waiting;
    if (!next || this.#isPatient(next.job)) return;
    const { job } = next;
    if (job.kind !== 'relax' && job.file && !this.#files.isReady(core, job.file)) return;
    this.#waiting = null;
    if (job.kind !== 'relax') {
      const answer = setField(core, job, this.#files);
      this.#post({ type: 'field', id: job.id, answer });
      if (!answer.ok) return;
    }
    this.#accepted = next;
  }
}
