/**
 * The page's side of the sampler: turns requests into jobs, takes what the worker sends, and keeps the signals true.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { clampSettings } from '../share/state.js';
import { idleProgress } from '../store.js';
import { CostModel, costKey, planLive, Scheduler, sizeOf } from './scheduler.js';
import { Supervisor } from './supervisor.js';

/**
 * @typedef {import('./protocol.js').FromWorker} FromWorker
 * @typedef {import('./protocol.js').Job} Job
 * @typedef {import('./supervisor.js').Crash} Crash
 * @typedef {import('./supervisor.js').WorkerLike} WorkerLike
 * @typedef {import('../columns.js').Columns} Columns
 * @typedef {import('../store.js').Store} Store
 * @typedef {import('../types.js').FieldRequest} FieldRequest
 * @typedef {import('../types.js').Settings} Settings
 */
/**
 * A wish for a run. `settings` are complete. `fit` lets the camera follow when the run is done; `confirmed` skips the question
 * whether so many particles are wanted; `restoring` makes the surface that stays on the page whole, while the state asks for
 * another that cannot be had.
 * @typedef {object} SampleRequest
 * @property {'sample'} kind
 * @property {FieldRequest} field
 * @property {Settings} settings
 * @property {boolean} grow
 * @property {boolean} live
 * @property {boolean} fit
 * @property {boolean} [confirmed]
 * @property {boolean} [restoring]
 * @property {boolean} [coarse]
 */
/** @typedef {import('../points/protocol.js').Solved} Solved */
/** @typedef {{kind: 'relax', of: number, steps: number, live: false, grow: true, fit: false, restoring?: false}} RelaxRequest */
/** @typedef {SampleRequest | RelaxRequest} RunRequest */
/**
 * A job at the worker. `bounds`: the clip box of its field; `begun`: its particles are on the page; `ended`: all of them are; `over`: nothing more is to come.
 * @typedef {{id: number, request: RunRequest, bounds: import('../types.js').Bounds | null, begun: boolean, ended: boolean, over: boolean, predicted: number, since_ms: number}} Run
 */
/**
 * What the picture does about it all.
 * @typedef {object} Picture
 * @property {(options: {grow: boolean, fit: boolean, bounds: import('../types.js').Bounds | null}) => void} begin  a new surface takes the place of the old one
 * @property {(first: number, last: number, onDrawn: () => void) => void} changed  columns first … last are new
 * @property {(from: number, last: number) => void} recolour  colours first … last may be new
 * @property {() => void} fit
 * @property {(dim: boolean) => void} dim
 */

/** The id under which a run's input is compared with another's. @param {RunRequest} request */
const inputOf = (request) =>
  JSON.stringify(request.kind === 'sample' ? [request.field, request.settings] : ['relax', request.steps]);

export class SamplingClient {
  /**
   * @param {object} options
   * @param {Store} options.store
   * @param {Columns} options.columns
   * @param {Picture} options.picture
   * @param {() => WorkerLike} options.spawn
   * @param {() => void} options.onReady  the description is there for the first time
   * @param {(predicted: number, request: SampleRequest) => void} options.onAsk
   * @param {() => SampleRequest} options.whole  a full run of the state as it is
   * @param {(key: string) => Solved | undefined} [options.solved]  the model that a field names
   * @param {import('./supervisor.js').Clock} [options.clock]
   */
  constructor({ store, columns, picture, spawn, onReady, onAsk, whole, solved = () => undefined, clock }) {
    this.store = store;
    this.columns = columns;
    this.picture = picture;
    this.onReady = onReady;
    this.onAsk = onAsk;
    this.whole = whole;
    this.solved = solved;
    /** What runs cost, by {@link costKey}. @type {Map<string, CostModel>} */
    this.costs = new Map();
    /** Whether the curvature is shown. */
    this.curvature = false;
    this.now_ms = clock ? clock.now : () => performance.now();
    /** @type {Scheduler<RunRequest>} */
    this.scheduler = new Scheduler((id, request) => this.dispatch(id, request), this.now_ms);
    this.supervisor = new Supervisor({
      spawn,
      clock,
      onMessage: (message) => this.receive(message),
      onRestart: (crash) => this.restarted(crash),
      onSafeMode: (crash) => this.safeMode(crash),
      onLoadError: (message) => this.loadFailed(`The sampler did not load: ${message}.`),
    });
    /** Jobs of whose field the worker has not spoken, by id. @type {Map<number, Run>} */
    this.asked = new Map();
    /** The job whose messages count: the last whose field was accepted. @type {Run | null} */
    this.current = null;
    /** Job whose particles the worker holds. */
    this.held = 0;
    /** The last sampling asked for that was accepted by the core. @type {SampleRequest | null} */
    this.accepted = null;
    /** The surface on the page is not the one that was asked for last. */
    this.astray = false;
    /** The sampling whose particles are on the page, and whether their report is too. @type {{request: SampleRequest, reported: boolean} | null} */
    this.shown = null;
    this.crashed_input = '';
    /** The last job that a stop was sent after: none up to it goes on. */
    this.stopping = 0;
    /** Messages of runs that are over. */
    this.stale = 0;
    /** @type {{requested: number, latencies: number[], coarse: boolean, particles: number, quiet_ms: number} | null} */
    this.drag = null;
  }

  start() {
    this.supervisor.start();
  }

  /** The curvature costs second derivatives, so it comes only while it is shown. @param {boolean} on */
  showCurvature(on) {
    if (on === this.curvature) return;
    this.curvature = on;
    this.supervisor.post({ type: 'curvature', on });
  }

  /** @param {SampleRequest} request */
  costOf({ field, settings }) {
    const key = costKey(field, settings);
    const cost = this.costs.get(key) ?? new CostModel();
    this.costs.set(key, cost);
    return cost;
  }

  // ---- requests -------------------------------------------------------------------------------------------------------

  /** @param {SampleRequest} request */
  sample(request) {
    const { running } = this.scheduler;
    // A second Run with the same input while the first is under way would only begin again. After a fault it says that there is none
    // any more, and of a surface that was only restored that it is the one asked for.
    const same =
      running &&
      running.id > this.stopping &&
      !running.request.live &&
      !running.request.restoring &&
      inputOf(running.request) === inputOf(request);
    if (!same || request.live || this.store.fieldError.value) this.scheduler.submit(request);
  }

  /**
   * A run for a control in motion, coarse if it has to be.
   * @param {SampleRequest} request @param {number} diagonal  of the clip box
   */
  sampleLive(request, diagonal) {
    const now = this.now_ms();
    if (!this.drag || now - this.drag.quiet_ms > 1000)
      this.drag = { requested: 0, latencies: [], coarse: false, particles: 0, quiet_ms: now };
    this.drag.requested += 1;
    this.drag.quiet_ms = now;
    const plan = planLive(request.settings, diagonal, this.costOf(request));
    this.drag.coarse ||= plan.coarse;
    const settings = this.store.description.value
      ? clampSettings(this.store.description.value, plan.settings)
      : plan.settings;
    this.scheduler.submit({ ...request, settings, coarse: plan.coarse, live: true, grow: false });
  }

  /** Relaxes the particles the worker holds; where they are gone, the whole run is made with so many steps more. @param {number} steps */
  relax(steps) {
    if (this.store.busy.value) return;
    if (this.held > 0 && this.columns.count > 0) {
      this.scheduler.submit({ kind: 'relax', of: this.held, steps, live: false, grow: true, fit: false });
    } else {
      const request = this.whole();
      const done = this.store.progress.value.relax_steps;
      this.sample({ ...request, grow: false, settings: { ...request.settings, relax_steps: done + steps } });
    }
  }

  stop() {
    if (!this.store.busy.value) return this.settle();
    this.scheduler.waiting = null;
    this.stopping = this.scheduler.last_id;
    this.supervisor.post({ type: 'stop' });
  }

  /** @param {number} id @param {RunRequest} request */
  dispatch(id, request) {
    if (!this.supervisor.worker) {
      // Safe mode: the wish is in the state, and is met when the sampler is started again.
      this.scheduler.drop();
      return;
    }
    /** @type {Run} */
    const run = {
      id,
      request,
      bounds: null,
      begun: false,
      ended: false,
      over: false,
      predicted: 0,
      since_ms: this.now_ms(),
    };
    /** @type {Job} */
    const job =
      request.kind === 'relax'
        ? { kind: 'relax', id, of: request.of, steps: request.steps, live: false, grow: true }
        : {
            kind: 'sample',
            id,
            field: request.field,
            settings: request.settings,
            grow: request.grow,
            live: request.live,
            points: (request.field.points !== undefined && this.solved(request.field.points)) || null,
            // A drag is never asked about: it stops at the limit.
            ask_above:
              request.confirmed || request.live || request.restoring
                ? Number.MAX_SAFE_INTEGER
                : Number(request.settings.max_particles),
          };
    this.supervisor.post({ type: 'job', job });
    if (request.kind === 'relax') {
      this.begin(run);
    } else {
      this.asked.set(id, run);
      this.attend();
    }
  }

  /** The worker is at another job: what is still on the way of the one before is not listened to. @param {Run} run */
  begin(run) {
    const { store } = this;
    const { id, request } = run;
    this.current = run;
    if (request.kind === 'sample') {
      this.held = 0;
      // Too many particles were asked for before: no longer.
      if (!request.restoring && store.notice.value?.id === 'size') store.notice.value = null;
    }
    store.progress.value = {
      ...idleProgress(),
      run: id,
      live: request.live,
      phase: request.kind === 'relax' ? 'relaxation' : 'seeding',
    };
    this.attend();
  }

  /** Something is under way: for the page until the particles are there, for the worker until their report is. */
  attend() {
    const { asked, current } = this;
    this.store.busy.value = asked.size > 0 || (current !== null && !current.ended);
    this.supervisor.setBusy(asked.size > 0 || (current !== null && !current.over));
  }

  // ---- what the worker sends --------------------------------------------------------------------------------------------

  /** @param {FromWorker} message */
  receive(message) {
    const { store } = this;
    if (message.type === 'ready') {
      const first = store.description.value === null;
      store.description.value = message.description;
      this.attend();
      if (this.curvature) this.supervisor.post({ type: 'curvature', on: true });
      if (first) this.onReady();
      return;
    }
    if (message.type === 'failed') return this.loadFailed(message.message);
    if (message.type === 'beat' || message.type === 'crashed') return;
    if (message.type === 'field') return this.fieldAnswered(message.id, message.answer);
    const { current } = this;
    if (!current || message.id !== current.id) {
      this.stale += 1;
      return;
    }
    switch (message.type) {
      case 'started':
        current.predicted = message.predicted;
        break;
      case 'progress':
        this.showProgress(message.progress);
        break;
      case 'columns':
        this.takeColumns(message, current);
        break;
      case 'done':
        this.ended(message, current);
        break;
      case 'report':
        this.reported(message, current);
        break;
      default:
    }
  }

  /** @param {import('../types.js').CoreProgress} progress */
  showProgress(progress) {
    const { current } = this;
    if (current) this.store.progress.value = { ...progress, run: current.id, live: current.request.live };
  }

  /** @param {number} id @param {import('../types.js').FieldAnswer} answer */
  fieldAnswered(id, answer) {
    const { store, asked, current } = this;
    const run = asked.get(id);
    if (run?.request.kind !== 'sample') return;
    // Jobs are asked about in their order: the worker never looked at those before that are still here.
    for (const other of asked.keys()) if (other <= id) asked.delete(other);
    const { request } = run;
    batch(() => {
      if (answer.ok) {
        run.bounds = answer.bounds;
        this.begin(run);
        this.accepted = request;
        if (request.restoring) return;
        this.astray = false;
        store.field.value =
          request.field.points !== undefined ? { ...answer, surface: request.field.surface ?? null } : answer;
        store.model.value = answer.model ?? null;
        store.fieldError.value = null;
        store.fieldPreview.value = answer.mathml;
      } else {
        store.fieldError.value = answer.error;
        store.fieldPreview.value = answer.mathml ?? null;
        if (!current)
          store.progress.value = { ...idleProgress(), run: id, phase: 'done', particles: this.columns.count };
        this.dim();
        this.attend();
        this.scheduler.ended(id, current && !current.ended ? current : null);
        this.settle();
      }
    });
  }

  /** The run that makes what is on the page anew, relaxed by so many steps more. @param {number} steps @returns {SampleRequest} */
  relaxed(steps) {
    const { request } = /** @type {NonNullable<SamplingClient['shown']>} */ (this.shown);
    const settings = { ...request.settings, relax_steps: Number(request.settings.relax_steps) + steps };
    const { value: description } = this.store.description;
    return {
      ...request,
      live: false,
      grow: false,
      fit: false,
      settings: description ? clampSettings(description, settings) : settings,
    };
  }

  /** Makes the surface that stays whole, and its report, where what cut it short came to nothing. */
  settle() {
    const { shown, current } = this;
    if (!shown || shown.reported || this.scheduler.running || (current && !current.over)) return;
    const request = { ...this.relaxed(0), restoring: true };
    if (inputOf(request) !== this.crashed_input) this.scheduler.submit(request);
  }

  /** Dims a surface that is not the one asked for. An empty editor is no mistake: nothing is dimmed for it. */
  dim() {
    const fault = this.store.fieldError.value;
    this.picture.dim(this.astray || this.columns.stale || (fault !== null && fault.kind !== 'empty'));
  }

  /** @param {import('./protocol.js').ColumnsMessage} message @param {NonNullable<SamplingClient['current']>} current */
  takeColumns(message, current) {
    const { columns, picture } = this;
    const { request } = current;
    const drawn = () => this.supervisor.post({ type: 'drawn', id: message.id });
    if (message.total === 0) {
      // No particle takes the place of those of the last surface: whether there will be one the end of the run tells.
      drawn();
      return;
    }
    if (!current.begun) {
      current.begun = true;
      this.store.report.value = null;
      if (request.kind === 'sample') {
        this.shown = { request, reported: false };
        columns.clear(request.settings.sampling === 'adaptive');
        picture.begin({ grow: request.grow, fit: request.fit, bounds: current.bounds });
        batch(() => {
          this.store.hover.value = null;
          this.store.empty.value = false;
        });
        this.dim();
      } else if (this.shown) {
        this.shown = { request: this.relaxed(request.steps), reported: false };
      }
    }
    const n = message.radii.length;
    if (!columns.write(message)) {
      drawn();
      return;
    }
    columns.writeSlots(message.slots_from, message.slots);
    if (message.curvature.length > 0) {
      columns.writeCurvature(message.curvature_from, message.curvature);
      picture.recolour(message.curvature_from, columns.count);
    }
    if (n > 0) picture.changed(message.first, message.first + n, drawn);
    else drawn();
    picture.recolour(message.slots_from, columns.count);
    if (message.progress) this.showProgress(message.progress);
    this.store.revision.value += 1;
  }

  /** @param {import('./protocol.js').DoneMessage} message @param {NonNullable<SamplingClient['current']>} current */
  ended(message, current) {
    const { store, columns, picture } = this;
    const { outcome, progress, seconds } = message;
    const { request } = current;
    const particles = progress?.particles ?? 0;
    const took_place = outcome === 'complete' || (outcome === 'stopped' && particles > 0);
    current.ended = true;
    current.over = !message.report_follows;
    batch(() => {
      this.attend();
      if (took_place) {
        const none = particles === 0;
        if (none) {
          // The last surface stays until there is another, dimmed, and is nothing to measure or to take away.
          columns.stale = columns.count > 0;
          this.shown = null;
          this.dim();
          store.report.value = null;
          store.hover.value = null;
        }
        this.held = none ? 0 : current.id;
        store.empty.value = none;
        store.revision.value += 1;
        store.partial.value = outcome === 'stopped' || progress?.stop_reason === 'cap';
        if (progress)
          store.progress.value = {
            ...progress,
            run: current.id,
            live: request.live,
            phase: message.report_follows ? 'quality' : 'done',
          };
        this.note(seconds, particles, progress?.relax_step ?? 0, progress?.radius ?? 0, current);
        if (request.fit && particles > 0) picture.fit();
      } else {
        // The surface before stays; a run of the same that was stopped at once leaves it what it was.
        const wanted = request.kind === 'sample' ? request : this.accepted;
        this.astray =
          request.restoring ||
          outcome !== 'stopped' ||
          JSON.stringify(this.shown?.request.field) !== JSON.stringify(wanted?.field);
        store.progress.value = {
          ...idleProgress(),
          run: current.id,
          phase: 'done',
          particles: columns.count,
          message: message.message || null,
        };
        this.dim();
        if (outcome === 'refused') {
          const { message: text } = message;
          store.notice.value = { id: 'size', kind: 'error', text: `${text.charAt(0).toUpperCase()}${text.slice(1)}.` };
        }
      }
    });
    this.scheduler.ended(message.id);
    if (request.kind !== 'sample') return;
    if (outcome === 'ask') this.onAsk(message.predicted, request);
    // After a drag that a mistake broke off no whole run comes.
    if ((!took_place && !request.restoring) || (request.live && store.fieldError.value)) this.settle();
  }

  /**
   * Learns from a run what the next will cost, and keeps the figures of a drag.
   * @param {import('../types.js').Seconds} seconds @param {number} particles @param {number} relax_steps @param {number} radius
   * @param {NonNullable<SamplingClient['current']>} current
   */
  note(seconds, particles, relax_steps, radius, { request, since_ms }) {
    const total = seconds.seeding + seconds.generation + seconds.relaxation;
    const cost = this.costOf(request.kind === 'sample' ? request : (this.accepted ?? this.whole()));
    if (request.kind === 'sample')
      cost.record({ seconds, particles, relax_steps, size: this.sizeOf(request.settings, radius) });
    this.store.timing.value = {
      total,
      seconds,
      us_per_particle: particles > 0 ? (total * 1e6) / particles : 0,
      particles,
      live: request.live,
    };
    const { drag } = this;
    if (request.live && drag) {
      const latency = this.now_ms() - since_ms;
      drag.latencies.push(latency);
      // What the sampler did not spend, drawing did: a slow graphics device holds up every message.
      cost.recordPicture(particles, latency - total * 1e3);
      drag.particles = particles;
      const sorted = [...drag.latencies].sort((a, b) => a - b);
      this.store.lastDrag.value = {
        requested: drag.requested,
        shown: drag.latencies.length,
        latency_ms: sorted[sorted.length >> 1],
        particles,
        coarse: drag.coarse,
      };
    }
  }

  /** A uniform run tells its radius also where the count decides. @param {Settings} settings @param {number} radius */
  sizeOf(settings, radius) {
    if (settings.sampling !== 'adaptive') return radius;
    const bounds = this.store.field.value?.bounds;
    return bounds ? sizeOf(settings, Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k]))) : NaN;
  }

  /** @param {import('./protocol.js').ReportMessage} message @param {NonNullable<SamplingClient['current']>} current */
  reported(message, current) {
    const { store, columns, picture } = this;
    if (message.valence.length === columns.count) {
      columns.valence = message.valence;
      columns.nearest = message.nearest;
      columns.residual = message.residual;
      columns.component = message.component.length === columns.count ? message.component : null;
    }
    const { seconds, count } = message.report;
    const total = seconds.seeding + seconds.generation + seconds.relaxation + seconds.quality;
    batch(() => {
      store.report.value = message.report;
      store.revision.value += 1;
      store.progress.value = { ...store.progress.value, phase: 'done' };
      store.timing.value = {
        total,
        seconds,
        us_per_particle: ((total - seconds.quality) * 1e6) / Math.max(1, count),
        particles: count,
        live: false,
      };
    });
    picture.recolour(0, columns.count);
    current.over = true;
    if (this.shown) this.shown.reported = true;
    this.attend();
  }

  // ---- when the worker fails ----------------------------------------------------------------------------------------------

  /** @param {Crash} crash @param {RunRequest | null} lost */
  describeCrash(crash, lost) {
    return [
      `Marching Particles ${this.store.description.value?.version ?? ''}: the sampler ${crash.cause === 'hang' ? 'fell silent' : 'stopped on an error'}`,
      crash.message,
      crash.stack,
      `job: ${lost ? JSON.stringify(lost) : 'none'}`,
      `restarts in the last minute: ${crash.restarts}`,
      typeof navigator === 'undefined' ? '' : navigator.userAgent,
    ]
      .filter(Boolean)
      .join('\n');
  }

  /**
   * Nothing is under way any more.
   * @returns {SampleRequest | null} what was, with a report that is still owed; a relaxation, whose particles are gone, as the run that ends with it
   */
  forget() {
    const { shown, current } = this;
    const dropped = this.scheduler.drop();
    let lost = dropped?.kind === 'sample' ? dropped : null;
    if (!lost && shown && (dropped || !shown.reported))
      lost = this.relaxed(dropped?.kind === 'relax' && !current?.begun ? dropped.steps : 0);
    this.current = null;
    this.asked.clear();
    this.held = 0;
    batch(() => {
      this.attend();
      this.store.progress.value = { ...idleProgress(), particles: this.columns.count };
    });
    return lost;
  }

  /** @param {Crash} crash */
  restarted(crash) {
    const lost = this.forget();
    const input = lost ? inputOf(lost) : '';
    const again = lost !== null && input !== this.crashed_input;
    this.crashed_input = input;
    const what =
      crash.cause === 'hang'
        ? 'The sampler fell silent and was restarted.'
        : 'The sampler stopped on an error and was restarted.';
    this.store.notice.value = {
      id: crash.cause,
      kind: again || !lost ? 'warn' : 'error',
      text:
        again || !lost
          ? `${what} Nothing was lost.`
          : `${what} The same input stopped it twice: change the formula or a setting.`,
      details: this.describeCrash(crash, lost),
    };
    if (!again) {
      this.astray ||= lost !== null;
      this.dim();
      return this.settle();
    }
    this.scheduler.submit(lost);
  }

  /** @param {Crash} crash */
  safeMode(crash) {
    const lost = this.forget();
    this.store.notice.value = {
      id: 'safe-mode',
      kind: 'error',
      text: 'The sampler failed four times within a minute and is now off. The picture, your formula and the exports stay.',
      details: this.describeCrash(crash, lost),
      action: { label: 'Start it again', run: () => this.revive() },
    };
  }

  /** @param {string} text */
  loadFailed(text) {
    this.forget();
    this.store.notice.value = {
      id: 'load',
      kind: 'error',
      text,
      details: text,
      action: { label: 'Try again', run: () => this.revive() },
    };
  }

  revive() {
    this.store.notice.value = null;
    this.crashed_input = '';
    this.supervisor.revive();
    if (this.store.description.value) this.scheduler.submit({ ...this.whole(), grow: false });
  }
}
