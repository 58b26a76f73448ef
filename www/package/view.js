/**
 * A picture of a surface in an element of a page, by the engine of the page of Marching Particles.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { createEngine } from '../src/engine/index.js';
import { atRest, once, settled } from '../src/engine/rest.js';
import { FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';

export { FormulaError, InputError, NoSurfaceError, WorkerError } from './errors.js';

/**
 * @import { Engine } from '../src/engine/types.js'
 * @import { Listeners, View, ViewState } from './view.js'
 */

/**
 * What went wrong with the present surface; null if nothing did. It reads signals.
 * @param {Engine} engine
 */
function faultOf(engine) {
  const fault = engine.fieldError.value;
  if (fault) return new FormulaError(fault.message, { ...fault, suggestion: fault.suggestion ?? null });
  const { message } = engine.progress.value;
  if (engine.empty.value) return new NoSurfaceError(message ?? 'There is no surface in the box.');
  const notice = engine.notice.value;
  return engine.debug.isOff() ? new WorkerError(notice?.text ?? 'The sampler did not start.') : null;
}

/**
 * What the events tell, whenever a signal that they read has another value; null tells nothing.
 * @type {{[name in keyof Listeners]: (engine: Engine) => Parameters<Listeners[name]>[0] | null}}
 */
const EVENTS = {
  progress(engine) {
    const { phase, particles, fraction } = engine.progress.value;
    return engine.busy.value ? { phase, particles, fraction } : null;
  },
  report: (engine) => (engine.busy.value ? null : engine.report.value),
  error: (engine) => (engine.busy.value ? null : faultOf(engine)),
};

/**
 * Draws a surface in an element, which it fills, and samples it.
 * @param {HTMLElement} host @param {ViewState} [state]
 * @returns {View}
 */
export function createView(host, state = {}) {
  if (!(host instanceof HTMLElement)) throw new InputError('createView(host): an element of the page.');
  if (getComputedStyle(host).position === 'static') host.style.position = 'relative';
  const engine = createEngine({ host, state: { ...state } });

  /** @param {() => void} act */
  async function after(act) {
    act();
    const report = await settled(engine);
    const fault = faultOf(engine);
    if (fault) throw fault;
    return report;
  }
  const ready = after(() => {});
  // Who does not wait for it hears of a fault by the event.
  ready.catch(() => {});

  return {
    ready,
    get state() {
      return structuredClone(engine.state.value);
    },
    get report() {
      return structuredClone(engine.report.value);
    },
    async set(patch) {
      await once(engine, () => engine.description.value !== null);
      return after(() => {
        const refused = engine.set({ ...patch });
        if (refused.length > 0) throw new InputError(`Not valid, and left as it was: ${refused.join(', ')}.`);
      });
    },
    setParameter: (name, value, { live = false } = {}) => engine.setParameter(name, value, { live }),
    run: () => after(() => engine.run()),
    stop() {
      engine.stop();
      return once(engine, () => atRest(engine));
    },
    particles() {
      const { columns } = engine;
      const count = columns.stale ? 0 : columns.count;
      return {
        count,
        positions: columns.positions.slice(0, 3 * count),
        normals: columns.normals.slice(0, 3 * count),
        radii: columns.radii.slice(0, count),
        levels: columns.levels.slice(0, count),
      };
    },
    on(name, listener) {
      const tell = EVENTS[name];
      if (!tell) throw new InputError(`on(): one of ${Object.keys(EVENTS).join(', ')}, not ${name}.`);
      return effect(() => {
        const told = tell(engine);
        if (told) queueMicrotask(() => /** @type {(told: object) => void} */ (listener)(told));
      });
    },
    fit: () => engine.fit(),
    lookFrom: (side) => engine.lookFrom(side),
    picture: (size) => engine.savePng(size),
    async toFile(format) {
      return new Uint8Array(await (await engine.exportMesh(format)).arrayBuffer());
    },
    link: () => engine.link(),
    destroy: () => engine.destroy(),
  };
}
