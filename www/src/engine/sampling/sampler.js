/**
 * Decides which runs the worker makes: turns requests into jobs, tracks the jobs by the worker's messages, and updates
 * the signals.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { clampSettings } from '../share/state.js';
import { SamplingClient } from './client.js';
import { Pace, sizeOfRun } from './cost.js';
import { loadNotice, restartNotice, safeModeNotice } from './faults.js';
import { KINDS } from './kinds.js';
import {
  askedFor,
  awaitsParticles,
  awaitsWorker,
  backdropOf,
  IDLE,
  inputOf,
  lostRun,
  reduce,
  restoringOf,
  runningOf,
  tookPlace,
  trialOf,
} from './ledger.js';
import { Presenter } from './presenter.js';

/**
 * @import { Description, FieldAnswer, FieldOk } from '../types.js'
 * @import {
 *   ColumnsMessage, Crash, DoneMessage, FromWorker, Job, LedgerEvent, RunRequest, SampleRequest, SamplerOptions,
 *   Ticket,
 * } from './types.js'
 */

export class Sampler {
  #columns;
  #presenter;
  #onReady;
  #onAsk;
  #whole;
  #nowMs;
  #pace;
  /** The job whose field was made last, or is being made. */
  #made = 0;

  /** @param {SamplerOptions} options */
  constructor({ store, columns, picture, spawn, onReady, onAsk, whole, solved = () => undefined, clock }) {
    this.store = store;
    this.#columns = columns;
    this.#presenter = new Presenter({ store, columns, picture });
    this.#onReady = onReady;
    this.#onAsk = onAsk;
    this.#whole = whole;
    this.solved = solved;
    this.#nowMs = clock ? clock.now : () => performance.now();
    this.#pace = new Pace(this.#nowMs);
    this.client = new SamplingClient({
      spawn,
      clock,
      onMessage: (message) => this.receive(message),
      onRestart: (crash) => this.#restarted(crash),
      onSafeMode: (crash) => this.#safeMode(crash),
      onLoadFailed: (text) => this.#loadFailed(text),
    });
    this.ledger = IDLE;
    /** Number of messages from runs that are over. */
    this.stale = 0;
  }

  /** The last sampling that the core accepted. */
  get accepted() {
    return this.ledger.accepted;
  }

  start() {
    this.client.start();
  }

  close() {
    this.client.close();
  }

  // ---- requests
  // -------------------------------------------------------------------------------------------------------

  /** @param {SampleRequest} request */
  sample(request) {
    const running = runningOf(this.ledger);
    // A second request with the same input would only restart the run, so it is ignored while the first one runs. It is
    // accepted after a fault, to clear the fault, and if the run only restores a surface, so that this surface becomes
    // the requested one.
    const same =
      running &&
      running.id > this.ledger.stoppedUpTo &&
      !KINDS[running.request.kind].isLive &&
      !KINDS[running.request.kind].restores &&
      inputOf(running.request) === inputOf(request);
    if (!same || KINDS[request.kind].isLive || this.store.fieldError.value) this.submit(request);
    else if (request.kind !== 'trial') this.commit();
  }

  /** Ends the trial of a formula, which stays. */
  commit() {
    this.#happened({ type: 'committed' });
  }

  /**
   * Lets the particles follow the surface while a control is dragged. If they cannot, a run starts, coarse if
   * necessary.
   * @param {SampleRequest} request @param {number} diagonal  of the clip box
   */
  sampleLive(request, diagonal) {
    const { coarse, settings } = this.#pace.plan(request, diagonal);
    const { value: description } = this.store.description;
    const valid = description ? clampSettings(description, settings) : settings;
    const following = [request.settings, valid];
    this.submit({ ...request, kind: coarse ? 'sketch' : 'live', settings: valid, following });
  }

  /**
   * Relaxes the worker's particles. If they are gone, the whole run is repeated with this many more steps.
   * @param {number} steps
   */
  relax(steps) {
    if (this.store.busy.value) return;
    const { held } = this.ledger;
    if (held > 0 && this.#columns.count > 0) {
      this.submit({ kind: 'relax', of: held, steps });
    } else {
      const request = this.#whole();
      const done = this.store.progress.value.relax_steps;
      this.sample({ ...request, settings: { ...request.settings, relax_steps: done + steps } });
    }
  }

  /** Stops everything requested so far. Nothing starts until the next request. */
  stop() {
    if (this.store.busy.value) this.client.post({ type: 'stop' });
    this.#happened({ type: 'stopped' });
  }

  /** Completes the surface that stays on the page, with its report, after a failed request. */
  #settle() {
    const request = restoringOf(this.ledger);
    if (request) this.submit(request);
  }

  /** Sends a request to the worker, where the latest one waits for the running job. @param {RunRequest} request */
  submit(request) {
    // In safe mode nothing is sent. The state keeps the request, which is sent when the sampler is restarted.
    if (!this.client.isThere) return this.#happened({ type: 'lost' });
    const id = this.ledger.lastId + 1;
    this.client.post({ type: 'job', job: this.#jobOf(id, request) });
    this.#happened({ type: 'sent', request, nowMs: this.#nowMs() });
    if (request.kind === 'relax') this.#presenter.begin(id, request);
  }

  /** @param {number} id @param {RunRequest} request @returns {Job} */
  #jobOf(id, request) {
    if (request.kind === 'relax') return { ...request, id };
    const { kind, field, settings, following = [] } = request;
    const solved = field.points === undefined ? undefined : this.solved(field.points);
    return {
      kind,
      id,
      field,
      settings,
      following,
      points: solved && 'field' in solved ? solved : null,
      file: solved && 'file' in solved ? solved.file : null,
      askAbove: KINDS[kind].isUnasked ? Number.MAX_SAFE_INTEGER : Number(settings.max_particles),
    };
  }

  /** @param {LedgerEvent} event */
  #happened(event) {
    this.ledger = reduce(this.ledger, event);
    this.#attend();
  }

  /** Updates the busy flags: the page is busy until the particles have arrived, the worker until the report has. */
  #attend() {
    this.store.busy.value = awaitsParticles(this.ledger);
    this.store.trial.value = trialOf(this.ledger);
    this.client.setBusy(awaitsWorker(this.ledger));
  }

  // ---- what the worker sends
  // --------------------------------------------------------------------------------------------

  /** @param {FromWorker} message */
  receive(message) {
    switch (message.type) {
      case 'ready':
        return this.#ready(message.description);
      case 'field':
        return this.#fieldAnswered(message.id, message.answer);
      case 'making':
        return this.#making(message.id, message.fraction);
      case 'dropped':
        this.#happened(message);
        if (!runningOf(this.ledger)) this.#presenter.idle({ phase: 'done' });
        return this.#dim();
      default:
    }
    const { current } = this.ledger;
    if (!('id' in message) || message.id !== current?.id) {
      this.stale += 1;
      return;
    }
    switch (message.type) {
      case 'box':
        return this.#boxFound(message.answer, current);
      case 'progress':
        if (!this.#isMaking) this.#presenter.progress(message.progress, current);
        return;
      case 'columns':
        return this.#takeColumns(this.#isMaking ? { ...message, progress: null } : message, current);
      case 'past':
        return this.#presenter.past(message, current);
      case 'done':
        return this.#ended(message, current);
      case 'value':
        return this.#presenter.valued(message);
      case 'change':
        return this.#presenter.compared(message);
      case 'record':
        return this.#presenter.record(message);
      case 'report':
        this.#presenter.report(message);
        return this.#happened({ type: 'reported' });
      default:
    }
  }

  /**
   * Shows how far the field of a job is, instead of the run that it replaces.
   * @param {number} id @param {number} fraction
   */
  #making(id, fraction) {
    const asked = askedFor(this.ledger, id);
    if (!asked || KINDS[asked.request.kind].isLive) return;
    this.#made = id;
    this.#presenter.making(asked, fraction);
  }

  /** Whether the field is made of the job that was asked for last, but for those of a drag. */
  get #isMaking() {
    return askedFor(this.ledger, this.#made) !== undefined;
  }

  /** @param {Description} description */
  #ready(description) {
    const first = this.store.description.value === null;
    this.store.description.value = description;
    if (first) this.#onReady();
  }

  /** @param {number} id @param {FieldAnswer} answer */
  #fieldAnswered(id, answer) {
    const request = askedFor(this.ledger, id)?.request;
    if (!request || request.kind === 'relax') return;
    batch(() => {
      if (answer.ok) this.#fieldAccepted(id, request, answer);
      else this.#fieldRefused(id, answer);
    });
  }

  /**
   * Makes the job the current one. Messages of the previous job are ignored from now on.
   * @param {number} id
   * @param {SampleRequest} request
   * @param {FieldOk} answer
   */
  #fieldAccepted(id, request, answer) {
    this.#happened({ type: 'accepted', id, bounds: answer.bounds });
    this.#presenter.begin(id, request);
    if (this.#isTold(request)) this.#presenter.field(request.field, answer, KINDS[request.kind].restores);
    if (answer.grip && !KINDS[request.kind].isLive && request.kind !== 'rest') this.store.dragging.value = false;
  }

  /**
   * Returns whether the page describes the field of this run. While the formula has a mistake, it describes the last
   * valid surface instead.
   * @param {SampleRequest} request
   */
  #isTold({ kind }) {
    return !KINDS[kind].restores || (kind !== 'backdrop' && this.store.fieldError.value !== null);
  }

  /**
   * Receives the box of a run, which is found after its field was accepted.
   * @param {FieldOk} answer
   * @param {Ticket} run
   */
  #boxFound(answer, { request }) {
    if (request.kind === 'relax') return;
    this.#happened({ type: 'boxed', bounds: answer.bounds });
    if (this.#isTold(request)) this.#presenter.box(answer);
  }

  /** @param {number} id @param {Extract<FieldAnswer, {ok: false}>} answer */
  #fieldRefused(id, answer) {
    this.#presenter.fault(answer);
    if (!this.ledger.current) this.#presenter.idle({ run: id, phase: 'done' });
    this.#dim();
    this.#happened({ type: 'refused', id });
    this.#settle();
  }

  /** Dims the surface if it is not the requested one. */
  #dim() {
    this.#presenter.dim(this.ledger.astray);
  }

  /** @param {ColumnsMessage} message @param {Ticket} run */
  #takeColumns(message, run) {
    const drawn = () => this.client.post({ type: 'drawn', id: message.id });
    // An empty range does not replace the previous surface. The end of the run shows whether there is a new one.
    if (message.total === 0) return drawn();
    if (run.stage === 'seeding') {
      this.#happened({ type: 'particles', description: this.store.description.value });
      this.#presenter.first(run);
      if (run.request.kind !== 'relax') this.#dim();
    }
    this.#presenter.particles(message, run, drawn);
  }

  /** @param {DoneMessage} message @param {Ticket} run */
  #ended(message, run) {
    const { outcome, progress, reportFollows } = message;
    const { request } = run;
    const particles = progress?.particles ?? 0;
    const surface = tookPlace(outcome, particles);
    batch(() => {
      this.#happened({ type: 'done', outcome, particles, reportFollows, nowMs: this.#nowMs() });
      if (surface) {
        this.#presenter.end(message, run, particles);
        if (request.kind !== 'backdrop') this.#learn(message, run, particles);
      } else {
        this.#presenter.failure(message);
      }
      if (!surface || particles === 0) this.#dim();
    });
    if (request.kind === 'relax') return;
    const behind = surface && particles === 0 && request.kind !== 'backdrop' ? backdropOf(this.ledger) : null;
    if (behind) this.submit(behind);
    if (outcome === 'ask') this.#onAsk(message.predicted, request);
    // After a drag that ended with an error no full run follows.
    const { isLive, restores } = KINDS[request.kind];
    if ((!surface && !restores) || (isLive && this.store.fieldError.value)) this.#settle();
  }

  /**
   * Updates the cost model from a finished run.
   * @param {DoneMessage} message
   * @param {Ticket} run
   * @param {number} particles
   */
  #learn({ seconds, progress, followed }, run, particles) {
    const { store } = this;
    const sampled = run.request.kind === 'relax' ? (this.accepted ?? this.#whole()) : run.request;
    const size = sizeOfRun(sampled.settings, progress?.radius ?? 0, store.field.value?.bounds);
    const drag = this.#pace.record(run, sampled, {
      seconds,
      particles,
      relax_steps: progress?.relax_step ?? 0,
      size,
      followed,
    });
    if (drag) store.lastDrag.value = drag;
  }

  // ---- when the worker fails
  // ----------------------------------------------------------------------------------------------

  /** Version of the core; empty until the core has loaded. */
  get #version() {
    return this.store.description.value?.version ?? '';
  }

  /**
   * Drops all runs, because the worker is gone.
   * @returns {SampleRequest | null} the run that is lost with the worker
   */
  #forget() {
    const lost = lostRun(this.ledger, this.store.description.value);
    this.client.forgetFiles();
    batch(() => {
      this.#happened({ type: 'lost' });
      // Before the core has described itself no run can have ended.
      this.#presenter.idle({ phase: this.store.description.value ? 'done' : 'idle' });
    });
    return lost;
  }

  /**
   * Repeats the lost run in the same step as the end of the old one, so that the page never sees an idle sampler in
   * between.
   * @param {Crash} crash
   */
  #restarted(crash) {
    batch(() => {
      const lost = this.#forget();
      const input = lost ? inputOf(lost) : '';
      const again = lost !== null && input !== this.ledger.crashedInput;
      this.#happened({ type: 'crashed', input, again });
      this.store.notice.value = restartNotice(crash, lost, { again, version: this.#version });
      if (again) {
        this.submit(lost);
      } else {
        this.#dim();
        this.#settle();
      }
    });
  }

  /** @param {Crash} crash */
  #safeMode(crash) {
    const lost = this.#forget();
    this.store.notice.value = safeModeNotice(crash, lost, this.#version, () => this.#revive());
  }

  /** @param {string} text */
  #loadFailed(text) {
    this.#forget();
    this.store.notice.value = loadNotice(text, () => this.#revive());
  }

  #revive() {
    this.store.notice.value = null;
    this.#happened({ type: 'revived' });
    this.client.revive();
    if (this.store.description.value) this.submit(this.#whole());
  }
}
