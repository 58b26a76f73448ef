/** A sampler without a worker: the tests speak for it. @module */
import { vi } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { Sampler } from '../../../src/engine/sampling/sampler.js';
import { createStore } from '../../../src/engine/store.js';
import { description } from './description.js';

/** @import { SampleJob } from '../../../src/engine/sampling/types.js' */

/** @type {any[]} */
export let workers = [];
/** The models that are there, by their keys. @type {Record<string, any>} */
export let solved = {};
/** What the picture was told. @type {string[]} */
export let told = [];

export const seconds = { seeding: 0.001, generation: 0.002, refinement: 0, relaxation: 0.003, quality: 0 };
export const progress = (/** @type {number} */ particles, /** @type {any} */ more = {}) => ({
  phase: 'generation',
  particles,
  attempt: 1,
  level: 1,
  refine_level: 0,
  refine_levels: 0,
  relax_step: 0,
  relax_steps: 10,
  evaluations: 0,
  fraction: 0.5,
  stop_reason: null,
  message: null,
  radius: 0.1,
  moved: false,
  ...more,
});
export const answer = (/** @type {string} */ formula) => ({
  ok: true,
  surface: null,
  formula,
  parameters: [],
  auto: [],
  bounds: { min: [-1, -1, -1], max: [1, 1, 1] },
  mathml: null,
});
export const columnsMessage = (/** @type {number} */ id, /** @type {number} */ n) => ({
  type: 'columns',
  id,
  first: 0,
  total: n,
  positions: new Float32Array(3 * n),
  normals: new Float32Array(3 * n),
  radii: new Float32Array(n),
  levels: new Uint32Array(n),
  parents: new Uint32Array(n),
  slotsFrom: 0,
  slots: new Uint32Array(n),
  curvatureFrom: 0,
  curvature: new Float32Array(0),
  mesh: null,
  progress: progress(n),
});
export const done = (
  /** @type {number} */ id,
  /** @type {string} */ outcome,
  /** @type {number} */ n = 0,
  more = {},
) => ({
  type: 'done',
  id,
  outcome,
  progress: progress(n, { phase: 'done', stop_reason: outcome === 'stopped' ? 'cancelled' : 'complete' }),
  seconds,
  predicted: n,
  message: '',
  reportFollows: false,
  ...more,
});

export const reportMessage = (/** @type {number} */ id, /** @type {number} */ n) => ({
  type: 'report',
  id,
  report: { count: n, seconds },
  own: {},
  valence: new Uint8Array(n),
  nearest: new Float32Array(n),
  residual: new Float32Array(n),
  energy: new Float32Array(n),
  component: new Uint32Array(n),
  patch: new Uint32Array(0),
  particle: new Uint32Array(0),
  periodic: new Uint32Array(0),
});

/**
 * `say` posts a message of the worker, `accept` and `refuse` its answers to a field; `start` asks for a run, whose field
 * is accepted; `finish` ends it with n particles, and `complete` with their figures, too.
 * @returns {{sampler: Sampler, store: ReturnType<typeof createStore>, columns: Columns, say: (message: any) => void,
 *   accept: (id: number, formula?: string) => void, refuse: (id: number) => void,
 *   start: (id: number, formula?: string) => void,
 *   finish: (id: number, n: number) => void, complete: (id: number, n: number) => void, jobs: () => any[]}}
 */
export function page() {
  const store = createStore();
  const columns = new Columns();
  const sampler = new Sampler({
    store,
    columns,
    picture: {
      begin: ({ grow, fit }) => told.push(`${grow ? 'grow' : 'swap'}${fit ? ' in view' : ''}`),
      changed: (first, last, drawn) => {
        told.push(`changed ${first}..${last}`);
        drawn();
      },
      remembered: () => {},
      meshed: () => told.push('mesh'),
      recolour: () => {},
      fit: () => told.push('fit'),
      dim: (dim) => told.push(dim ? 'dim' : 'clear'),
    },
    models: {
      key: () => undefined,
      ready: () => true,
      present: () => store.state.value,
      load: () => {},
      settled: () => {},
      solved: (key) => solved[key],
      orderKey: '',
      cancel: () => {},
    },
    spawn: () => {
      const worker = {
        posted: /** @type {any[]} */ ([]),
        postMessage: (/** @type {any} */ m) => worker.posted.push(m),
        terminate() {},
        onmessage: null,
        onerror: null,
      };
      workers.push(worker);
      return worker;
    },
    onReady: () => told.push('ready'),
    clock: { now: () => Date.now(), setTimeout: (f, ms) => setTimeout(f, ms), clearTimeout },
  });
  store.state.value = { ...store.state.value, formula: 'whole' };
  sampler.start();
  const say = (/** @type {any} */ message) => workers.at(-1).onmessage?.({ data: message });
  say({ type: 'ready', description });
  const accept = (/** @type {number} */ id, formula = 'x') => say({ type: 'field', id, answer: answer(formula) });
  const error = { kind: 'unexpected_end', message: 'no', start: 0, end: 1, suggestion: null, mended: null, name: null };
  return {
    sampler,
    store,
    columns,
    say,
    accept,
    refuse: (id) => say({ type: 'field', id, answer: { ok: false, error } }),
    start(id, formula = 'x') {
      sampler.sample(request(formula));
      accept(id, formula);
    },
    finish(id, n) {
      say(columnsMessage(id, n));
      say(done(id, 'complete', n));
    },
    complete(id, n) {
      say(columnsMessage(id, n));
      say(done(id, 'complete', n, { reportFollows: true }));
      say(reportMessage(id, n));
    },
    jobs: () =>
      workers
        .at(-1)
        .posted.filter((/** @type {any} */ m) => m.type === 'job')
        .map((/** @type {any} */ m) => ({ id: m.id, ...m.job, given: m.given })),
  };
}
/** @param {string} formula @param {Partial<SampleJob>} [more] @returns {SampleJob} */
export const request = (formula, more = {}) => ({
  kind: 'grow',
  field: { formula },
  settings: { max_particles: 1000, relax_steps: 10 },
  asksAbove: 1000,
  ...more,
});

/** Before each test: no worker, nothing told, a clock that the test moves. */
export function begin() {
  vi.useFakeTimers();
  workers = [];
  solved = {};
  told = [];
}
