/**
 * Runs one job in the worker, on the field that is set in the core: the steps of the sampling, the measurement, and the
 * messages about both. The clock, the pause and the function that posts are parameters, so that tests can use a
 * scripted core.
 *
 * @module
 */
import { painted } from '../brush.js';
import { inSlices } from '../bundle/slices.js';
import { MEASURED } from '../columns.js';
import { MOST_STEPPED } from '../constants.js';
import { join } from './joining.js';
import { KINDS } from './kinds.js';
import { BEAT_MS, PROGRESS_MS } from './protocol.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { Bounds, CoreProgress, Figures, Seconds, Settings } from '../types.js'
 * @import { ColumnsMessage, DoneMessage, Env, Job, Memory, Mesh, Numbered } from './types.js'
 */

/** First budget of a phase. No unit takes more than a third of a millisecond, so a Stop takes effect within 100 ms. */
const FIRST_BUDGET = 256;
/** Shortest interval between column messages: about one frame at 60 Hz. */
const PICTURE_MS = 15;

/**
 * Returns the entry of the times that a phase of the core belongs to.
 * @param {CoreProgress['phase']} phase
 * @returns {keyof Seconds}
 */
function clockOf(phase) {
  if (phase === 'flow') return 'relaxation';
  return phase === 'generation' || phase === 'refinement' || phase === 'relaxation' ? phase : 'seeding';
}

/**
 * Returns a message without columns, about particles that the page already has.
 * @param {Core} core @param {number} id
 * @returns {ColumnsMessage}
 */
const bare = (core, id) => ({
  type: 'columns',
  id,
  first: core.count(),
  total: core.count(),
  positions: new Float32Array(0),
  normals: new Float32Array(0),
  radii: new Float32Array(0),
  levels: new Uint32Array(0),
  parents: new Uint32Array(0),
  slotsFrom: core.count(),
  slots: new Uint32Array(0),
  curvatureFrom: 0,
  curvature: new Float32Array(0),
  mesh: null,
  creases: null,
  progress: null,
});

/**
 * Returns a message with the curvature of all particles, which the page already has.
 * @param {Core} core @param {number} id
 * @returns {[ColumnsMessage, Transferable[]]}
 */
export function curvatureColumn(core, id) {
  const curvature = core.curvature(0);
  return [{ ...bare(core, id), curvature }, [curvature.buffer]];
}

/**
 * Returns a message with the mesh over all particles, which the page already has.
 * @param {Core} core @param {number} id @param {Mesh} mesh
 * @returns {[ColumnsMessage, Transferable[]]}
 */
export const meshColumn = (core, id, mesh) => [{ ...bare(core, id), mesh }, [mesh.triangles.buffer]];

/**
 * Runs a job until it ends or is interrupted.
 * @param {Core} core
 * @param {Pick<Numbered, 'id' | 'job'>} numbered
 * @param {Env} env
 * @param {Memory} memory
 */
export async function runJob(core, { id, job }, env, memory) {
  const run = new Run(core, id, job, env);
  if (!(await run.fit(memory)) || run.isOver() || !run.start(memory)) return;
  const last = await run.sample();
  if (!last) {
    memory.held = 0;
    return;
  }
  if (!(await run.complete(last, memory))) {
    memory.held = 0;
    return;
  }
  const stopped = last.stop_reason === 'cancelled' || (memory.gaveUp && memory.meshed === id);
  const reported = (!KINDS[job.kind].isLive || stopped) && core.count() > 0;
  run.done(stopped ? 'stopped' : 'complete', '', reported);
  run.record();
  if (reported) await run.measure();
}

/** The run of a job, in the worker: its times, its latest progress, and what the page has received. */
class Run {
  #isLive;
  #grows;

  /** The box of the run, once it is found. @type {Bounds | null} */
  #bounds = null;
  /** Time of the last message, a sign of life. */
  #beatMs;
  #isHanding;

  /** @param {Core} core @param {number} id @param {Job} job @param {Env} env */
  constructor(core, id, job, env) {
    const { isLive = false, grows = false } = KINDS[job.kind];
    this.#isLive = isLive;
    this.#grows = grows;
    this.core = core;
    this.id = id;
    this.job = job;
    this.env = env;
    /** @type {Seconds} */
    this.seconds = { seeding: 0, generation: 0, refinement: 0, relaxation: 0, quality: 0 };
    /** @type {CoreProgress | null} */
    this.progress = null;
    this.predicted = 0;
    /** Whether the particles of the previous run followed the surface. */
    this.followed = false;
    /** Positions before each relaxation step. @type {Float32Array[]} */
    this.past = [];
    this.#beatMs = 0;
    /** Whether the refinement is passing a level on. */
    this.#isHanding = false;
    /** What the page has: columns of `count` particles, and all final slot fates if `settled`. */
    this.sent = { count: 0, onCreases: 0, stale: false, slotsFrom: 0, settled: false, curved: 0, pictureMs: -Infinity };
  }

  /** @param {DoneMessage['outcome']} outcome @param {string} [message] @param {boolean} [reportFollows] */
  done(outcome, message = '', reportFollows = false) {
    const { id, progress, predicted, followed } = this;
    const seconds = { ...this.seconds };
    this.env.post({
      type: 'done',
      id,
      outcome,
      progress,
      seconds,
      predicted,
      followed,
      message,
      reportFollows,
    });
  }

  /** Sends the record of the particles. It follows the end, since the digest of a million takes 0.1 s. */
  record() {
    const record = this.core.record();
    if (record) this.env.post({ type: 'record', id: this.id, record });
  }

  /**
   * Finds the box of a sampling and the creases in it, in slices, so that a slow formula does not delay the next key.
   * @param {{held: number}} memory
   * @returns false if the job has ended already
   */
  async fit(memory) {
    const { core, job, env } = this;
    if (job.kind === 'relax') return true;
    memory.held = 0;
    this.#beatMs = env.nowMs();
    // What is painted changes the box only by its margin, and needs its diagonal.
    const { brush: _, ...settings } = job.settings;
    const slice = (/** @type {number} */ budget) => core.fit(settings, this.#isLive, budget);
    const { made: answer, why } = await inSlices(slice, env, {
      after: (tookMs) => {
        this.seconds.seeding += tookMs / 1000;
        this.#beat();
      },
    });
    if (why === 'stop') return this.#end('stopped');
    if (!answer) return false;
    if (!answer.ok) return this.#end('refused', answer.error.message);
    this.#bounds = answer.bounds;
    env.post({ type: 'box', id: this.id, answer });
    return true;
  }

  /** Regularly shows the page that the worker is alive. */
  #beat() {
    const { env } = this;
    if (env.nowMs() - this.#beatMs <= BEAT_MS) return;
    env.post({ type: 'beat' });
    this.#beatMs = env.nowMs();
  }

  /**
   * Regularly reports the progress of the work after the run.
   * @param {'mesh' | 'quality'} phase
   */
  #tellAfter(phase) {
    const { core, env, progress } = this;
    if (env.nowMs() - this.#beatMs <= PROGRESS_MS) return;
    if (progress) {
      env.post({ type: 'progress', id: this.id, progress: { ...progress, phase, fraction: core.fraction() } });
    } else {
      env.post({ type: 'beat' });
    }
    this.#beatMs = env.nowMs();
  }

  /**
   * Whether the job ends before it starts. A job that was stopped while waiting leaves the particles where they are:
   * after a few steps towards its surface they would lie on no surface.
   */
  isOver() {
    const why = this.env.interrupt();
    if (why === 'stop') this.done('stopped');
    return why !== null;
  }

  /**
   * Starts the sampling or the relaxation in the core.
   * @param {Memory} memory
   * @returns false if the job has ended already
   */
  start(memory) {
    const { core, job, env } = this;
    if (job.kind !== 'relax') {
      // Here the core looks for the surface; for a model that is most of the seeding.
      const before = env.nowMs();
      const inBox = (/** @type {Settings} */ settings) => (this.#bounds ? painted(settings, this.#bounds) : settings);
      this.followed = job.following?.some((settings) => core.follow(inBox(settings), false)) ?? false;
      if (this.followed) {
        this.seconds.seeding += (env.nowMs() - before) / 1000;
        memory.held = this.id;
        return true;
      }
      const start = core.start(inBox(job.settings));
      this.seconds.seeding += (env.nowMs() - before) / 1000;
      if (!start.ok) return this.#end('refused', start.error.message);
      const { radius, predicted_count: predicted, warnings } = start;
      this.predicted = predicted;
      env.post({ type: 'started', id: this.id, radius, predicted, warnings });
      if (predicted > job.asksAbove && !KINDS[job.kind].isUnasked) {
        core.cancel();
        return this.#end('ask');
      }
    } else {
      if (memory.held !== job.of) return this.#end('lost');
      this.past.push(core.positions(0));
      core.relax(job.steps);
      this.sent.count = core.count();
    }
    memory.held = this.id;
    return true;
  }

  /** @param {DoneMessage['outcome']} outcome @param {string} [message] @returns {false} */
  #end(outcome, message) {
    this.done(outcome, message);
    return false;
  }

  /**
   * Steps the core until it is done or the job is stopped.
   * @returns the last progress; null if another job replaces this one, or it ended without particles
   */
  async sample() {
    const { core, job, env } = this;
    /** @type {CoreProgress['phase']} */
    let phase = job.kind === 'relax' ? 'relaxation' : 'seeding';
    core.plan(this.#isLive ? 'nothing' : 'front_too', env.mesh());
    this.#beatMs = env.nowMs();
    const { made: last, why } = await inSlices((budget) => this.#step(budget), env, {
      first: FIRST_BUDGET,
      phase: () => phase,
      after: (tookMs) => {
        this.seconds[clockOf(phase)] += tookMs / 1000;
        const { progress } = this;
        if (!progress || progress.stop_reason) return;
        phase = progress.phase;
        this.#remember(progress);
        this.#tell(progress);
      },
    });
    return why === 'stop' ? this.#cancelled() : last;
  }

  /**
   * Steps the core once. Returns the progress at the end of the run.
   * @param {number} budget
   */
  #step(budget) {
    const { core, job, sent } = this;
    const wasHanding = this.#isHanding;
    const progress = core.step(budget);
    this.progress = progress;
    sent.stale ||= progress.moved;
    if (progress.phase === 'done') return progress;
    // A refinement moves particles while it passes a level on, the coarse one first, and then works below them.
    this.#isHanding = progress.phase === 'refinement' && progress.moved;
    if (job.kind !== 'sketch' || job.settings.method !== 'refined' || !wasHanding || this.#isHanding) return undefined;
    this.progress = { ...core.cancel(), stop_reason: 'complete' };
    return this.progress;
  }

  /** Ends a stopped run. Returns its last progress; null if it leaves no particles. */
  #cancelled() {
    const last = this.core.cancel();
    // Particles that follow lie on no surface until they have reached the new one.
    const isNowhere = this.followed && this.sent.count === 0;
    this.progress = isNowhere ? null : last;
    if (isNowhere) this.done('stopped');
    return this.progress;
  }

  /** Keeps the positions before each relaxation step. @param {CoreProgress} progress */
  #remember(progress) {
    const { core, past } = this;
    if (this.#isLive || progress.phase !== 'relaxation' || this.#stepsOf(progress) !== past.length) return;
    if (past.length === 0 || core.count() <= MOST_STEPPED) past.push(core.positions(0));
  }

  /** Returns the number of relaxation steps of this run so far. @param {CoreProgress} progress */
  #stepsOf({ relax_step, relax_steps }) {
    return this.job.kind === 'relax' ? relax_step - (relax_steps - this.job.steps) : relax_step;
  }

  /** Sends columns if they are due, else the progress from time to time. @param {CoreProgress} progress */
  #tell(progress) {
    const { env } = this;
    if (this.#isDue(progress)) this.#sendColumns(progress);
    else if (env.nowMs() - this.#beatMs > PROGRESS_MS) env.post({ type: 'progress', id: this.id, progress });
    else return;
    this.#beatMs = env.nowMs();
  }

  /** Returns whether the page should receive columns after this step. @param {CoreProgress} progress */
  #isDue({ phase }) {
    const { core, env, sent } = this;
    if (!env.room() || env.nowMs() - sent.pictureMs < PICTURE_MS) return false;
    if (this.#isLive || (!this.#grows && phase !== 'relaxation' && phase !== 'refinement')) return false;
    // A mesh on the page stays until the next one is complete, unless the surface should be seen growing.
    if (env.mesh() && (this.job.kind === 'relax' || !this.#grows)) return false;
    return sent.stale || core.count() > sent.count;
  }

  /** @param {CoreProgress} progress @param {Mesh | null} [mesh] */
  #sendColumns(progress, mesh = null) {
    const { core, env, sent } = this;
    const total = core.count();
    const first = sent.stale ? 0 : Math.min(sent.count, total);
    const slotsFrom = sent.stale ? 0 : Math.min(sent.slotsFrom, first);
    // Relaxation moves particles only slightly, so their curvature is updated once, at the end.
    const curvatureFrom = sent.curved;
    const curvature = env.curvature() ? core.curvature(curvatureFrom) : new Float32Array(0);
    sent.curved += curvature.length / 2;
    const twins = core.twins();
    const isNew = first === 0 || twins.length !== sent.onCreases;
    const creases = isNew ? { twins, segments: core.segments(), seams: core.seams() } : null;
    sent.onCreases = twins.length;
    const columns = {
      positions: core.positions(first),
      exact: core.exact_positions(first),
      normals: core.normals(first),
      radii: core.radii(first),
      levels: core.levels(first),
      parents: core.parents(first),
      slots: core.slots(slotsFrom),
      curvature,
    };
    env.post(
      { type: 'columns', id: this.id, first, total, slotsFrom, curvatureFrom, ...columns, mesh, creases, progress },
      [...Object.values(columns), ...(mesh ? [mesh.triangles] : []), ...Object.values(creases ?? {})].map(
        (c) => c.buffer,
      ),
    );
    // Fates of a particle's slots are decided after the particle is sent, so the next message sends them again.
    sent.slotsFrom = first;
    sent.settled = slotsFrom === 0;
    sent.count = total;
    sent.stale = false;
    sent.pictureMs = env.nowMs();
  }

  /**
   * Sends what the page lacks after the last step: particles, final slot fates, curvature, and the mesh if it is drawn.
   * @param {CoreProgress} last @param {Memory} memory
   * @returns false if another job replaces this one
   */
  async complete(last, memory) {
    const { core, env, sent } = this;
    if (last.relax_step > 0) sent.curved = 0;
    const wanted = env.mesh() && core.count() > 0;
    const mesh = wanted ? await join(core, env, () => this.#tellAfter('mesh')) : null;
    if (wanted && !mesh && env.interrupt() === 'replace') return false;
    // A mesh that was stopped is made again only when it is requested again.
    if (wanted) [memory.meshed, memory.gaveUp] = [this.id, !mesh];
    if (core.count() > sent.count || sent.stale) this.#sendColumns(last, mesh);
    else if (mesh) env.post(...meshColumn(core, this.id, mesh));
    if (!sent.settled) {
      const slots = core.slots(0);
      env.post({ ...bare(core, this.id), slotsFrom: 0, slots, progress: last }, [slots.buffer]);
    }
    // Without another step the last stored positions are the current ones, which are not sent again.
    const positions = this.past.slice(0, this.#stepsOf(last));
    if (positions.length > 0) {
      env.post(
        { type: 'past', id: this.id, positions },
        positions.map(({ buffer }) => buffer),
      );
    }
    this.#sendCurvature();
    return true;
  }

  /** Sends the curvature of all particles if the page shows it and lacks it. */
  #sendCurvature() {
    const { core, env, sent } = this;
    if (!env.curvature() || sent.curved === core.count()) return;
    env.post(...curvatureColumn(core, this.id));
    sent.curved = core.count();
  }

  /** Measures the particles slice by slice and posts the report, unless another job replaces this one. */
  async measure() {
    const { core, env, seconds } = this;
    const unlessReplaced = {
      ...env,
      interrupt: () => (env.interrupt() === 'replace' ? /** @type {const} */ ('replace') : null),
    };
    const slice = (/** @type {number} */ budget) => {
      this.#sendCurvature();
      return core.measure('front_too', budget);
    };
    const { made: report } = await inSlices(slice, unlessReplaced, {
      after: (tookMs) => {
        seconds.quality += tookMs / 1000;
        this.#tellAfter('quality');
      },
    });
    if (!report) return;
    const figures = /** @type {Figures} */ (Object.fromEntries(MEASURED.map((name) => [name, core[name]()])));
    const own = Object.fromEntries(core.value_names().map((name) => [name, core.added_value(name)]));
    env.post(
      { type: 'report', id: this.id, report: { ...report, seconds: { ...seconds } }, own, ...figures },
      [...Object.values(figures), ...Object.values(own)].map((c) => c.buffer),
    );
  }
}
