/**
 * One job in the worker, from its start on the field that the core has to the report: the step loop, its pace and what it posts. The clock, the pause
 * between steps and the way out are handed in, so that the loop can be run in tests on a scripted core.
 *
 * @module
 */
import { nextBudget } from '../bundle/budget.js';
import { BEAT_MS, PROGRESS_MS } from './protocol.js';

/**
 * @typedef {import('./protocol.js').Job} Job
 * @typedef {import('./protocol.js').FromWorker} FromWorker
 * @typedef {import('./protocol.js').DoneMessage} DoneMessage
 * @typedef {import('../types.js').CoreProgress} CoreProgress
 * @typedef {import('../types.js').Seconds} Seconds
 */
/**
 * The core's class as the loop uses it.
 * @typedef {object} CoreLike
 * @property {(request: import('../types.js').FieldRequest) => import('../types.js').FieldAnswer} set_field
 * @property {(system: Uint8Array, about: import('../types.js').SolvedModel) => import('../types.js').FieldAnswer} set_points
 * @property {(settings: import('../types.js').Settings) => import('../types.js').StartAnswer} start
 * @property {(budget: number) => CoreProgress} step
 * @property {(steps: number) => void} relax
 * @property {() => CoreProgress} cancel
 * @property {() => number} count
 * @property {(from: number) => Float32Array} positions
 * @property {(from: number) => Float32Array} normals
 * @property {(from: number) => Float32Array} radii
 * @property {(from: number) => Uint32Array} levels
 * @property {(from: number) => Uint32Array} parents
 * @property {(from: number) => Uint32Array} slots
 * @property {(from: number) => Float32Array} curvature  two per particle
 * @property {(budget: number) => import('../types.js').CoreReport | undefined} measure  the report, once it is complete
 * @property {() => Uint8Array} valence
 * @property {() => Float32Array} nearest
 * @property {() => Float32Array} residual
 * @property {() => Uint32Array} component
 */
/**
 * @typedef {object} Surroundings
 * @property {() => number} nowMs
 * @property {() => Promise<void>} pause  lets messages in
 * @property {(message: FromWorker, transfer?: Transferable[]) => void} post
 * @property {() => 'stop' | 'replace' | null} interrupt
 * @property {() => boolean} curvature  whether the page shows it
 * @property {() => boolean} room  whether the page has drawn what it was sent
 */

/**
 * The first budget of a phase, in work units; the pace then follows the machine. A unit of the slowest sampling, the paper's own
 * placement on a model, takes a third of a millisecond: a Stop is heard within 100 ms also then.
 */
const FIRST_BUDGET = 256;
/** The same of a measurement, whose pieces take up to a tenth of a millisecond. */
const FIRST_PIECES = 32;
/** One picture at 60 Hz. */
const PICTURE_MS = 15;
/** Which of the four clocks a phase of the core runs on. @param {CoreProgress['phase']} phase @returns {keyof Seconds} */
function clockOf(phase) {
  if (phase === 'relaxation') return 'relaxation';
  return phase === 'generation' ? 'generation' : 'seeding';
}

/** Columns of no particle. */
const none = () => ({
  positions: new Float32Array(0),
  normals: new Float32Array(0),
  radii: new Float32Array(0),
  levels: new Uint32Array(0),
  parents: new Uint32Array(0),
});

/**
 * The curvature of particles that the page has.
 * @param {CoreLike} core @param {number} id
 * @returns {[import('./protocol.js').ColumnsMessage, Transferable[]]}
 */
export function curvatureColumn(core, id) {
  const curvature = core.curvature(0);
  const total = core.count();
  return [
    {
      type: 'columns',
      id,
      first: total,
      total,
      ...none(),
      slotsFrom: total,
      slots: new Uint32Array(0),
      curvatureFrom: 0,
      curvature,
      progress: null,
    },
    [curvature.buffer],
  ];
}

/**
 * Runs a job to its end, or until it is interrupted.
 * @param {CoreLike} core
 * @param {Job} job
 * @param {Surroundings} env
 * @param {{held: number}} memory  id of the job whose particles the core holds, 0 for none
 * @returns {Promise<void>}
 */
export async function runJob(core, job, env, memory) {
  /** @type {Seconds} */
  const seconds = { seeding: 0, generation: 0, relaxation: 0, quality: 0 };
  const { id } = job;
  /** @type {CoreProgress | null} */
  let progress = null;
  let predicted = 0;

  /** @param {DoneMessage['outcome']} outcome @param {string} [message] @param {boolean} [reportFollows] */
  const done = (outcome, message = '', reportFollows = false) =>
    env.post({ type: 'done', id, outcome, progress, seconds: { ...seconds }, predicted, message, reportFollows });

  if (job.kind === 'sample') {
    memory.held = 0;
    // The search for the surface begins with the start, and on a model most of it is there.
    const before = env.nowMs();
    const start = core.start(job.settings);
    seconds.seeding += (env.nowMs() - before) / 1000;
    if (!start.ok) return done('refused', start.error.message);
    predicted = start.predicted_count;
    env.post({ type: 'started', id, radius: start.radius, predicted, warnings: start.warnings });
    if (predicted > job.askAbove) {
      core.cancel();
      return done('ask');
    }
  } else {
    if (memory.held !== job.of) return done('lost');
    core.relax(job.steps);
  }
  memory.held = id;

  // What the page has: columns of `count` particles, and whether the fates of all their slots are the latest.
  const sent = {
    count: job.kind === 'sample' ? 0 : core.count(),
    stale: false,
    slotsFrom: 0,
    settled: false,
    curved: 0,
    pictureMs: -Infinity,
  };
  let beatMs = env.nowMs();
  /** @type {Record<string, number>} */
  const budgets = {};
  /** @type {CoreProgress['phase']} */
  let phase = job.kind === 'sample' ? 'seeding' : 'relaxation';

  let last = /** @type {CoreProgress} */ (/** @type {unknown} */ (null));

  /** Whether the page should see columns now, between two steps. */
  const due = () => {
    if (!env.room() || env.nowMs() - sent.pictureMs < PICTURE_MS) return false;
    if (job.live) return false;
    if (!job.grow && last.phase !== 'relaxation') return false;
    return sent.stale || core.count() > sent.count;
  };
  const sendColumns = () => {
    const total = core.count();
    const first = sent.stale ? 0 : Math.min(sent.count, total);
    const slotsFrom = sent.stale ? 0 : Math.min(sent.slotsFrom, first);
    // A relaxed particle has not gone far: until the end its curvature stays what it was when it was placed.
    const curvatureFrom = sent.curved;
    const curvature = env.curvature() ? core.curvature(curvatureFrom) : new Float32Array(0);
    sent.curved += curvature.length / 2;
    const columns = {
      positions: core.positions(first),
      normals: core.normals(first),
      radii: core.radii(first),
      levels: core.levels(first),
      parents: core.parents(first),
      slots: core.slots(slotsFrom),
      curvature,
    };
    env.post(
      { type: 'columns', id, first, total, slotsFrom, curvatureFrom, ...columns, progress: last },
      Object.values(columns).map((c) => c.buffer),
    );
    // The fates of a particle's slots are decided after it was sent: they go along with the next piece.
    sent.slotsFrom = first;
    sent.settled = slotsFrom === 0;
    sent.count = total;
    sent.stale = false;
    sent.pictureMs = env.nowMs();
  };

  for (;;) {
    const why = env.interrupt();
    if (why === 'replace') {
      memory.held = 0;
      return;
    }
    if (why === 'stop') {
      last = core.cancel();
      progress = last;
      break;
    }
    const budget = budgets[phase] ?? FIRST_BUDGET;
    const before = env.nowMs();
    last = core.step(budget);
    progress = last;
    const took = env.nowMs() - before;
    seconds[clockOf(phase)] += took / 1000;
    budgets[phase] = nextBudget(budget, took);
    sent.stale ||= last.moved;
    if (last.phase === 'done') break;
    phase = last.phase;
    if (due()) {
      sendColumns();
      beatMs = env.nowMs();
    } else if (env.nowMs() - beatMs > PROGRESS_MS) {
      env.post({ type: 'progress', id, progress });
      beatMs = env.nowMs();
    }
    await env.pause();
  }

  // At the end the page has every particle, and the final fate of every slot.
  if (last.relax_step > 0) sent.curved = 0;
  if (core.count() > sent.count || sent.stale) sendColumns();
  if (!sent.settled) {
    const slots = core.slots(0);
    const total = core.count();
    env.post(
      {
        type: 'columns',
        id,
        first: total,
        total,
        ...none(),
        slotsFrom: 0,
        slots,
        curvatureFrom: 0,
        curvature: new Float32Array(0),
        progress: last,
      },
      [slots.buffer],
    );
  }
  const tellCurvature = () => {
    if (!env.curvature() || sent.curved === core.count()) return;
    env.post(...curvatureColumn(core, id));
    sent.curved = core.count();
  };
  tellCurvature();
  const stopped = last.stop_reason === 'cancelled';
  const reported = (!job.live || stopped) && core.count() > 0;
  done(stopped ? 'stopped' : 'complete', '', reported);
  if (!reported) return;

  let pieces = FIRST_PIECES;
  /** @type {import('../types.js').CoreReport | undefined} */
  let report;
  do {
    await env.pause();
    if (env.interrupt() === 'replace') return;
    tellCurvature();
    const before = env.nowMs();
    report = core.measure(pieces);
    const took = env.nowMs() - before;
    seconds.quality += took / 1000;
    pieces = nextBudget(pieces, took);
    if (env.nowMs() - beatMs > BEAT_MS) {
      env.post({ type: 'beat' });
      beatMs = env.nowMs();
    }
  } while (report === undefined);
  const figures = {
    valence: core.valence(),
    nearest: core.nearest(),
    residual: core.residual(),
    component: core.component(),
  };
  env.post(
    { type: 'report', id, report: { ...report, seconds: { ...seconds } }, ...figures },
    Object.values(figures).map((c) => c.buffer),
  );
}
