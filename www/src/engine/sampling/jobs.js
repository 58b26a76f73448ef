/**
 * The only queue of jobs in the worker: one job runs, and the latest one waits. A job replaces the running one only
 * once the core has accepted its field. A refused field changes nothing in the core, so the running job continues, and
 * the surface on the page is completed and measured.
 *
 * @module
 */
import { KINDS } from './kinds.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FileKeeper } from '../files/keeper.js'
 * @import { KeyedFile } from '../files/types.js'
 * @import { FieldAnswer } from '../types.js'
 * @import { FromWorker, Job, Numbered, SampleJob, ToWorker } from './types.js'
 */

/**
 * Time after which a live job is replaced by one with newer values. Before that it continues, since otherwise no job
 * would finish. So does the run of a control that rests, since the surface can be followed from its particles again.
 */
const PATIENCE_MS = 150;

/**
 * Opens files in the core and makes fields of them. `isReady` does so for a job if necessary, and the worker then asks
 * again. `stop` ends that.
 * @typedef {object} Files
 * @property {(core: Core, id: number, file: KeyedFile, field: SampleJob['field']) => boolean} isReady
 * @property {FileKeeper['setField']} setField
 * @property {() => void} stop
 */
/** Used if no job has a file. @type {Files} */
const NO_FILES = {
  isReady: () => true,
  setField: () => {
    throw new Error('there are no files here');
  },
  stop: () => {},
};

/** A job that has not started. @typedef {Numbered & {stopped: boolean}} Pending */

/**
 * Sets a job's field in the core. A model is passed again with every job: it has a few kilobytes, and keeping track of
 * the core's model would cost more.
 * @param {Core} core @param {SampleJob} job @param {Numbered['given']} given @param {Files} files
 * @returns {FieldAnswer}
 */
function setField(core, { field }, given, files) {
  if (!given) return core.set_field(field);
  if ('file' in given) return files.setField(core, given.file, field);
  return core.set_points(given.field, given.info, field);
}

/**
 * Measures particles that were placed elsewhere. The core takes their field, so it must not be sampling anything.
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

  /** The latest job, whose field the core does not have yet. @type {Pending | null} */
  #waiting;

  /** The job whose file is opened, or whose field is made. @type {Pending | null} */
  #making;

  /**
   * The job whose field the core has accepted. It starts when the running job has ended.
   * @type {Pending | null}
   */
  #accepted;

  /** Whether the running job must stop. */
  #stopped;

  /** When the running job began, and whether all its particles have been sent to the page. */
  #running = { sinceMs: 0, isSampled: false };

  /** @param {(message: FromWorker) => void} post @param {() => number} nowMs @param {Files} [files] */
  constructor(post, nowMs, files = NO_FILES) {
    this.#post = post;
    this.#nowMs = nowMs;
    this.#files = files;
    this.#waiting = null;
    this.#making = null;
    this.#accepted = null;
    /** The running job. @type {Numbered | null} */
    this.running = null;
    this.#stopped = false;
  }

  /** @param {Numbered} next */
  add({ id, job, given }) {
    this.#waiting = { id, job, given, stopped: false };
  }

  /**
   * Stops all jobs so far. A waiting job that would follow the running one's particles is dropped: its surface has none
   * yet, and the running job must keep its field, to which the particles belong. So is one whose field is being made.
   */
  stop() {
    this.#stopped = true;
    if (this.#making) {
      this.#post({ type: 'dropped', id: this.#making.id });
      this.#making = null;
      this.#files.stop();
    }
    const waiting = this.#waiting;
    if (this.running && waiting && waiting.job.kind !== 'relax' && waiting.job.following?.length) {
      this.#post({ type: 'dropped', id: waiting.id });
      this.#waiting = null;
    }
    if (this.#waiting) this.#waiting.stopped = true;
    if (this.#accepted) this.#accepted.stopped = true;
  }

  /** Sets the next job's field in the core, and begins and returns the job. @param {Core} core */
  take(core) {
    this.running = null;
    this.#ask(core);
    const next = this.#accepted;
    this.#accepted = null;
    this.#stopped = next?.stopped ?? false;
    this.running = next;
    this.#running = { sinceMs: this.#nowMs(), isSampled: false };
    return this.running;
  }

  /**
   * Returns what the running job must do. The job calls this between steps.
   * @param {Core} core
   */
  interrupt(core) {
    this.#ask(core);
    if (this.#accepted) return 'replace';
    return this.#stopped ? 'stop' : null;
  }

  /** Records that the running job has its particles. Only its report is left, for which no other job waits. */
  sampled() {
    this.#running.isSampled = true;
  }

  /**
   * Whether a job waits for the end of the running one, which would otherwise be replaced again and again.
   * @param {Job} job
   */
  #isPatient({ kind }) {
    const { running } = this;
    if (!running || this.#running.isSampled || !KINDS[kind].isLive) return false;
    const isSpared = KINDS[running.job.kind].isLive || running.job.kind === 'rest';
    return isSpared === true && this.#nowMs() - this.#running.sinceMs < PATIENCE_MS;
  }

  /**
   * Takes the job whose field is to be set next. A field that is being made is completed while a control moves, since
   * otherwise none would be.
   */
  #next() {
    const waiting = this.#waiting;
    if (this.#making && (!waiting || KINDS[waiting.job.kind].isLive)) return this.#making;
    if (!waiting || this.#isPatient(waiting.job)) return null;
    this.#waiting = null;
    return waiting;
  }

  /** @param {Core} core */
  #ask(core) {
    const next = this.#next();
    this.#making = null;
    if (!next) return;
    const { id, job, given } = next;
    if (job.kind !== 'relax') {
      if (given && 'file' in given && !this.#files.isReady(core, id, given.file, job.field)) {
        this.#making = next;
        return;
      }
      const answer = setField(core, job, given, this.#files);
      this.#post({ type: 'field', id, answer });
      if (!answer.ok) return;
    }
    this.#accepted = next;
  }
}
