/**
 * Decides which runs the worker makes: turns the state into jobs, tracks their runs by the worker's messages, and
 * updates the signals.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { TYPING_MS } from '../constants.js';
import { clampSettings, completeSettings, fieldRequest, validSetting } from '../share/state.js';
import { change, description } from '../store.js';
import { SamplingClient } from './client.js';
import { loadNotice, restartNotice, safeModeNotice } from './faults.js';
import { KINDS } from './kinds.js';
import {
  askedFor,
  backdropOf,
  IDLE,
  inputOf,
  lostRun,
  reduce,
  restoringOf,
  runningOf,
  statusOf,
  tookPlace,
  trialOf,
} from './ledger.js';
import { Drag, Pace, paceKey, samplingSeconds, sizeOfRun } from './pace.js';
import { Presenter } from './presenter.js';

/**
 * @import { Description, FieldAnswer, FieldOk, SampleKind, Settings } from '../types.js'
 * @import {
 *   Change, ColumnsMessage, Crash, DoneMessage, FromWorker, Job, LedgerEvent, Run, SampleJob, SamplerOptions,
 * } from './types.js'
 */

/** Pause in a drag after which the full run starts, even if the control did not report its release. */
const REST_MS = 250;

/** Number of particles above which the user is asked first, who may have set a radius that is too small. */
const MOST_UNASKED = 200_000;

/**
 * The number of particles above which the user is asked: the limit that was set, if one was.
 * @param {Description} about @param {Settings} settings  complete
 */
function mostUnasked(about, settings) {
  const limit = Number(settings.max_particles);
  return limit === about.settings.find(({ name }) => name === 'max_particles')?.default ? MOST_UNASKED : limit;
}

export class Sampler {
  #columns;
  #models;
  #presenter;
  #onReady;
  #nowMs;
  /** By {@link paceKey}. @type {Map<string, Pace>} */
  #paces = new Map();
  #drag = new Drag(-Infinity);
  /** The run whose field was made last, or is being made. */
  #made = 0;
  /**
   * Timer for the run that starts when a control or the typing pauses.
   * @type {ReturnType<typeof setTimeout> | undefined}
   */
  #timer;
  #isTyping = false;

  /** @param {SamplerOptions} options */
  constructor({ store, columns, picture, models, spawn, onReady, clock }) {
    this.store = store;
    this.#columns = columns;
    this.#models = models;
    this.#presenter = new Presenter({ store, columns, picture });
    this.#onReady = onReady;
    this.#nowMs = clock ? clock.now : () => performance.now();
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
    this.forgetLater();
    this.#models.cancel();
    this.client.close();
  }

  // ---- what the state asks for
  // ------------------------------------------------------------------------------------------

  /**
   * Returns the job that samples the current state, or the surface that is being pulled.
   * @param {Change} [change]
   * @returns {SampleJob}
   */
  #jobOf({ kind = 'change', pulled, settings: given } = {}) {
    const about = description(this.store);
    const state = this.#models.present();
    const isMesh = this.store.meshing.value !== null;
    const own = completeSettings(about, isMesh ? { ...state.settings, method: 'refined' } : state.settings);
    const settings = given ?? own;
    const follows = state.view.flow && (kind === 'move' || kind === 'rest');
    return {
      kind,
      field: { ...fieldRequest(state, about, this.#models.key()), ...pulled },
      settings,
      following: follows ? [settings] : [],
      asksAbove: mostUnasked(about, settings),
    };
  }

  /** Samples the current state. @param {Change} [change] */
  resample(change = {}) {
    if (!this.#begin(change.kind)) return;
    const job = this.#jobOf(change);
    // The answer tells when a pull has ended.
    if (change.pulled) this.submit(job);
    else this.sample(job);
  }

  /**
   * Samples the current state during a drag, coarsely if necessary, and fully once the drag pauses.
   * @param {Change['pulled']} [pulled]
   */
  resampleLive(pulled) {
    if (!this.#begin()) return;
    this.sampleLive(this.#jobOf({ pulled }), this.#diagonal());
    this.#timer = setTimeout(() => this.sample(this.#jobOf({ kind: 'rest', pulled })), REST_MS);
  }

  /**
   * Samples another surface. A model that is loading for another choice is cancelled.
   * @param {SampleKind} [kind]
   */
  choose(kind) {
    this.store.loadingError.value = null;
    if (this.#models.orderKey !== this.#models.key()) this.#models.cancel();
    this.resample({ kind });
  }

  /** Samples a typed formula once the typing pauses, unless another run comes first. */
  chooseTyped() {
    clearTimeout(this.#timer);
    this.#setTyping(true);
    this.#timer = setTimeout(() => this.choose('trial'), TYPING_MS);
  }

  /** Cancels a run that is waiting for a pause. */
  forgetLater() {
    clearTimeout(this.#timer);
    this.#setTyping(false);
  }

  /** @param {boolean} isTyping */
  #setTyping(isTyping) {
    this.#isTyping = isTyping;
    this.#attend();
  }

  /**
   * Whether the state can be sampled now. If its model is not solved yet, solving begins.
   * @param {SampleKind} [kind]
   */
  #begin(kind) {
    this.forgetLater();
    this.store.spot.value = null;
    if (!this.store.description.value) return false;
    if (!this.#models.ready()) {
      void this.#models.load(kind);
      return false;
    }
    this.#models.settled();
    return true;
  }

  /** Returns the diagonal of the current clip box. */
  #diagonal() {
    const { state, field } = this.store;
    const bounds = state.value.bounds ?? field.value?.bounds;
    return bounds ? Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k])) : 0;
  }

  /**
   * Asks the user to confirm a run with more particles than the limit.
   * @param {number} predicted
   * @param {SampleJob} job
   */
  #askSize(predicted, job) {
    const { store } = this;
    const limit = job.asksAbove;
    const raised = Math.ceil(predicted * description(store).limits.count_room);
    store.notice.value = {
      id: 'size',
      kind: 'error',
      text: `About ${predicted.toLocaleString('en')} particles would be needed; the limit is ${limit.toLocaleString('en')}.`,
      action: {
        label: 'Sample them anyway',
        run: () => {
          store.notice.value = null;
          const maxParticles =
            validSetting(description(store), 'max_particles', raised) ?? Number(job.settings.max_particles);
          change(store, { settings: { ...store.state.value.settings, max_particles: maxParticles } });
          this.sample(this.#jobOf({ kind: 'agreed' }));
        },
      },
    };
  }

  // ---- jobs
  // -------------------------------------------------------------------------------------------------------------

  /** @param {SampleJob} job */
  sample(job) {
    const running = runningOf(this.ledger);
    // A second job with the same input would only restart the run, so it is ignored while the first one runs. It is
    // accepted after a fault, to clear the fault, and if the run only restores a surface, so that this surface becomes
    // the requested one.
    const same =
      running &&
      running.id > this.ledger.stoppedUpTo &&
      !KINDS[running.job.kind].isLive &&
      !KINDS[running.job.kind].restores &&
      inputOf(running.job) === inputOf(job);
    if (!same || KINDS[job.kind].isLive || this.store.fieldError.value) this.submit(job);
    else if (job.kind !== 'trial') this.commit();
  }

  /** Ends the trial of a formula, which stays. */
  commit() {
    this.#happened({ type: 'committed' });
  }

  /**
   * Lets the particles follow the surface while a control is dragged. If they cannot, a run starts, coarse if
   * necessary.
   * @param {SampleJob} job @param {number} diagonal  of the clip box
   */
  sampleLive(job, diagonal) {
    this.#drag = this.#drag.requested(this.#nowMs());
    const { coarse, settings } = this.#paceOf(job).plan(job.settings, diagonal);
    const valid = clampSettings(description(this.store), settings);
    this.submit({ ...job, kind: coarse ? 'sketch' : 'live', settings: valid, following: [job.settings, valid] });
  }

  /** @param {SampleJob} job @returns {Pace} */
  #paceOf(job) {
    const key = paceKey(job);
    const pace = this.#paces.get(key) ?? new Pace();
    this.#paces.set(key, pace);
    return pace;
  }

  /**
   * Relaxes the worker's particles. If they are gone, the whole run is repeated with this many more steps.
   * @param {number} steps
   */
  relax(steps) {
    if (this.store.status.value === 'sampling') return;
    const { held } = this.ledger;
    if (held > 0 && this.#columns.count > 0) {
      this.submit({ kind: 'relax', of: held, steps });
    } else {
      const job = this.#jobOf();
      const done = this.store.progress.value.relax_steps;
      this.sample({ ...job, settings: { ...job.settings, relax_steps: done + steps } });
    }
  }

  /** Stops everything requested so far. Nothing starts until the next request. */
  stop() {
    this.forgetLater();
    this.#models.cancel();
    if (this.store.status.value === 'sampling') this.client.post({ type: 'stop' });
    this.#happened({ type: 'stopped' });
  }

  /** Completes the surface that stays on the page, with its report, after a failed run. */
  #settle() {
    const job = restoringOf(this.ledger);
    if (job) this.submit(job);
  }

  /** Sends a job to the worker, where the latest one waits for the running one. @param {Job} job */
  submit(job) {
    // In safe mode nothing is sent. The state has what was asked for, which is sampled when the sampler is restarted.
    if (!this.client.isThere) return this.#happened({ type: 'lost' });
    const id = this.ledger.lastId + 1;
    const points = job.kind === 'relax' ? undefined : job.field.points;
    const given = (points === undefined ? null : this.#models.solved(points)) ?? null;
    this.client.post({ type: 'job', id, job, given });
    this.#happened({ type: 'sent', job, nowMs: this.#nowMs() });
    if (job.kind === 'relax') this.#presenter.begin(id, job);
  }

  /** @param {LedgerEvent} event */
  #happened(event) {
    this.ledger = reduce(this.ledger, event);
    this.#attend();
  }

  /** Updates what is under way, for the page and for whoever watches the worker. */
  #attend() {
    const status = statusOf(this.ledger);
    this.store.status.value = status;
    this.store.trial.value = this.#isTyping ? 'typing' : trialOf(this.ledger);
    this.client.setBusy(status !== 'rest');
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
        if (this.store.status.value === 'rest') this.#presenter.idle({ phase: 'done' });
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
    if (!asked || KINDS[asked.job.kind].isLive) return;
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
    const job = askedFor(this.ledger, id)?.job;
    if (!job || job.kind === 'relax') return;
    batch(() => {
      if (answer.ok) this.#fieldAccepted(id, job, answer);
      else this.#fieldRefused(id, answer);
    });
  }

  /**
   * Makes the job the current one. Messages of the previous job are ignored from now on.
   * @param {number} id
   * @param {SampleJob} job
   * @param {FieldOk} answer
   */
  #fieldAccepted(id, job, answer) {
    this.#happened({ type: 'accepted', id, bounds: answer.bounds });
    this.#presenter.begin(id, job);
    if (this.#isTold(job)) this.#presenter.field(job.field, answer, KINDS[job.kind].restores);
    if (answer.grip && !KINDS[job.kind].isLive && job.kind !== 'rest') this.store.dragging.value = false;
  }

  /**
   * Returns whether the page describes the field of this run. While the formula has a mistake, it describes the last
   * valid surface instead.
   * @param {SampleJob} job
   */
  #isTold({ kind }) {
    return !KINDS[kind].restores || (kind !== 'backdrop' && this.store.fieldError.value !== null);
  }

  /**
   * Receives the box of a run, which is found after its field was accepted.
   * @param {FieldOk} answer
   * @param {Run} run
   */
  #boxFound(answer, { job }) {
    if (job.kind === 'relax') return;
    this.#happened({ type: 'boxed', bounds: answer.bounds });
    if (this.#isTold(job)) this.#presenter.box(answer);
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

  /** @param {ColumnsMessage} message @param {Run} run */
  #takeColumns(message, run) {
    const drawn = () => this.client.post({ type: 'drawn', id: message.id });
    // An empty range does not replace the previous surface. The end of the run shows whether there is a new one.
    if (message.total === 0) return drawn();
    if (run.stage === 'seeding') {
      this.#happened({ type: 'particles', description: this.store.description.value });
      this.#presenter.first(run);
      if (run.job.kind !== 'relax') this.#dim();
    }
    this.#presenter.particles(message, run, drawn);
  }

  /** @param {DoneMessage} message @param {Run} run */
  #ended(message, run) {
    const { outcome, progress, reportFollows } = message;
    const { job } = run;
    const particles = progress?.particles ?? 0;
    const surface = tookPlace(outcome, particles);
    batch(() => {
      this.#happened({ type: 'done', outcome, particles, reportFollows, nowMs: this.#nowMs() });
      if (surface) {
        this.#presenter.end(message, run, particles);
        if (job.kind !== 'backdrop') this.#learn(message, run, particles);
      } else {
        this.#presenter.failure(message);
      }
      if (!surface || particles === 0) this.#dim();
    });
    if (job.kind === 'relax') return;
    const behind = surface && particles === 0 && job.kind !== 'backdrop' ? backdropOf(this.ledger) : null;
    if (behind) this.submit(behind);
    if (outcome === 'ask') this.#askSize(message.predicted, job);
    // After a drag that ended with an error no full run follows.
    const { isLive, restores } = KINDS[job.kind];
    if ((!surface && !restores) || (isLive && this.store.fieldError.value)) this.#settle();
  }

  /**
   * Updates the pace and the drag from a finished run.
   * @param {DoneMessage} message
   * @param {Run} run
   * @param {number} particles
   */
  #learn({ seconds, progress, followed }, { job, sinceMs }, particles) {
    const { store } = this;
    if (job.kind === 'relax') return;
    const pace = this.#paceOf(job);
    // A run that ended at its coarse level, or whose particles followed, does not tell the cost of a whole run.
    const isWhole = !followed && !(job.kind === 'sketch' && job.settings.method === 'refined');
    const size = sizeOfRun(job.settings, progress?.radius ?? 0, store.field.value?.bounds);
    if (isWhole) pace.record({ seconds, particles, relax_steps: progress?.relax_step ?? 0, size });
    if (!KINDS[job.kind].isLive) return;
    const latencyMs = this.#nowMs() - sinceMs;
    // The rest of the latency is drawing: a slow graphics device delays every message.
    pace.recordPicture(particles, latencyMs - samplingSeconds(seconds) * 1e3);
    store.lastDrag.value = this.#drag.shown(latencyMs, particles, job.kind === 'sketch' && !followed);
  }

  // ---- when the worker fails
  // ----------------------------------------------------------------------------------------------

  /** Version of the core; empty until the core has loaded. */
  get #version() {
    return this.store.description.value?.version ?? '';
  }

  /**
   * Drops all runs, because the worker is gone.
   * @returns {SampleJob | null} the run that is lost with the worker
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
    if (this.store.description.value) this.submit(this.#jobOf());
  }
}
