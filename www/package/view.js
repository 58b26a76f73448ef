/**
 * A picture of a surface in an element of any page, drawn by the engine of the Marching Particles page.
 *
 * @module
 */
import { effect, signal } from '@preact/signals-core';
import { createEngine } from '../src/engine/index.js';
import { atRest, once, settled } from '../src/engine/rest.js';
import { defaultState, mergeState } from '../src/engine/share/state.js';
import { description } from '../src/engine/store.js';
import { BACKENDS } from '../src/engine/view/backends.js';
import { DisposedError, FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';
import { appliedTo, engineChange, namesOf, viewState } from './state.js';

export { DisposedError, FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';

/**
 * @import { Engine, ReadonlySignal, Signal, State } from '../src/engine/types.js'
 * @import { Listeners, View, ViewOptions, ViewState } from './view.js'
 */

/**
 * The fault of the current surface; null if there is none. It reads signals.
 * @param {Engine} engine
 */
function faultOf(engine) {
  const fault = engine.fieldError.value;
  if (fault) return new FormulaError(fault.message, { ...fault, suggestion: fault.suggestion ?? null });
  const { message } = engine.progress.value;
  if (engine.result.value === 'none') return new NoSurfaceError(message ?? 'There is no surface in the box.');
  const notice = engine.notice.value;
  return engine.debug.isOff() ? new WorkerError(notice?.text ?? 'The sampler did not start.') : null;
}

/**
 * The events' details, sent whenever a signal that they read changes; null sends nothing. `unread` is the error of the
 * first state.
 * @type {{[name in keyof Listeners]:
 *   (engine: Engine, unread: ReadonlySignal<Error | null>) => Parameters<Listeners[name]>[0] | null}}
 */
const EVENTS = {
  progress(engine) {
    const { phase, particles, fraction } = engine.progress.value;
    return engine.status.value === 'sampling' ? { phase, particles, fraction } : null;
  },
  report: (engine) => (engine.status.value === 'sampling' ? null : engine.report.value),
  error: (engine, unread) => unread.value ?? (engine.status.value === 'sampling' ? null : faultOf(engine)),
};

/** Returns what has a promise rejected at the end of a view, which else would never settle, and what ends it. */
function lifetime() {
  /** An entry is removed with its promise, since a view may make many. @type {Set<(error: Error) => void>} */
  const waiting = new Set();
  let isOver = false;
  const gone = () => new DisposedError('The view was destroyed.');
  return {
    /** @template T @param {Promise<T>} promise @returns {Promise<T>} */
    alive: (promise) =>
      new Promise((resolve, reject) => {
        if (isOver) reject(gone());
        waiting.add(reject);
        promise.then(resolve, reject).finally(() => waiting.delete(reject));
      }),
    end() {
      isOver = true;
      for (const reject of waiting) reject(gone());
    },
  };
}

/**
 * Draws a surface in an element, which it fills, and samples it.
 * @param {HTMLElement} host @param {ViewState} [state] @param {ViewOptions} [options]
 * @returns {View}
 */
export function createView(host, state = {}, { backend } = {}) {
  if (!(host instanceof HTMLElement)) throw new InputError('createView(host): an element of the page.');
  if (backend !== undefined && !BACKENDS.includes(backend))
    throw new InputError(`createView(): backend is one of ${BACKENDS.join(', ')}, not ${backend}.`);
  if (getComputedStyle(host).position === 'static') host.style.position = 'relative';
  const { rest, set } = engineChange(state);
  const first = { ...rest, settings: set };
  const engine = createEngine({ host, state: first, backend });
  const { alive, end } = lifetime();
  /** The error of an invalid first state, until another state is set. @type {Signal<Error | null>} */
  const unread = signal(null);
  // Anything requested before the engine has the first state would be overwritten by it.
  const begun = once(engine, () => engine.state.value.surface !== '');

  /** The invalid parts of a change of a state. @param {State} now @param {Record<string, unknown>} patch */
  const refused = (now, patch) => namesOf(mergeState(now, patch, description(engine), false).reset);

  /** @param {() => void} act */
  async function after(act) {
    await alive(begun);
    // The engine also begins without a core if no sampler comes; then there is nothing to act on.
    if (engine.description.value) act();
    const report = await alive(settled(engine));
    const fault = faultOf(engine);
    if (fault) throw fault;
    return report;
  }
  const ready = after(() => {
    const names = refused(defaultState(description(engine)), first);
    if (names === '') return;
    unread.value = new InputError(`Not valid, and replaced by defaults: ${names}.`);
    throw unread.value;
  });
  // Callers who do not wait for it learn of a fault from the event.
  ready.catch(() => {});

  return {
    ready,
    get state() {
      return viewState(engine.state.value, engine.description.value);
    },
    get report() {
      return structuredClone(engine.report.value);
    },
    get backend() {
      const kind = engine.backend.value;
      return kind === 'starting' ? null : kind;
    },
    async set(patch) {
      const change = engineChange(patch);
      return after(() => {
        const now = engine.state.value;
        const whole = appliedTo(change, now, description(engine));
        const names = refused(now, whole);
        if (names !== '') throw new InputError(`Not valid, and left as it was: ${names}.`);
        engine.set(whole);
        unread.value = null;
      });
    },
    setParameter(name, value, { live = false } = {}) {
      const act = () => engine.setParameter(name, value, { live });
      alive(begun).then(act, () => {});
    },
    run: () => after(() => engine.run()),
    stop() {
      engine.stop();
      return alive(once(engine, () => atRest(engine)));
    },
    particles() {
      const { columns } = engine;
      const count = columns.stale ? 0 : columns.count;
      return {
        points: columns.positions.slice(0, 3 * count),
        normals: columns.normals.slice(0, 3 * count),
        radii: columns.radii.slice(0, count),
        levels: columns.levels.slice(0, count),
      };
    },
    on(name, listener) {
      const tell = EVENTS[name];
      if (!tell) throw new InputError(`on(): one of ${Object.keys(EVENTS).join(', ')}, not ${name}.`);
      return effect(() => {
        const told = tell(engine, unread);
        if (told) queueMicrotask(() => /** @type {(told: object) => void} */ (listener)(told));
      });
    },
    fit: () => engine.fit(),
    lookFrom: (side) => engine.lookFrom(side),
    picture: (size) => alive(engine.savePng(size)),
    async toFile(format) {
      return new Uint8Array(await (await alive(engine.exportMesh(format))).arrayBuffer());
    },
    link: () => engine.link(),
    destroy() {
      end();
      engine.destroy();
    },
  };
}
