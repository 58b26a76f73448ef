/**
 * Decides which job runs next.
 *
 * @module
 */

/**
 * Time after which a live job is replaced by one with newer values. Until then it continues; otherwise no job would
 * finish.
 */
const PATIENCE_MS = 150;

/**
 * Keeps at most one job at the worker and one waiting, whatever the rate of requests. The latest request wins.
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
   * Notes that the worker has finished a job.
   * @param {number} id
   * @param {Scheduler<T>['running']} [before]  the job that continues because the field of this one was refused
   * @returns {boolean} false if the job is no longer the current one
   */
  ended(id, before = null) {
    if (this.running?.id !== id) return false;
    this.running = before;
    const { waiting } = this;
    this.waiting = null;
    if (waiting) this.send(waiting);
    return true;
  }

  /** Drops all jobs, because the worker is gone. @returns {T | null} the running job, or else the waiting one */
  drop() {
    const lost = this.waiting ?? this.running?.request ?? null;
    this.running = null;
    this.waiting = null;
    return lost;
  }
}
