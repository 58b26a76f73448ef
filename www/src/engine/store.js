/**
 * The engine's signals in writable form. The interface sees them read-only.
 *
 * @module
 */
import { signal } from '@preact/signals-core';
import { emptyState } from './share/state.js';

/** @import { EngineSignals, Progress, ReadonlySignal, Signal, State, ViewState } from './types.js' */

/** @returns {Progress} */
export const idleProgress = () => ({
  run: 0,
  live: false,
  phase: 'idle',
  particles: 0,
  rows: 0,
  attempt: 1,
  level: 0,
  refine_level: 0,
  refine_levels: 0,
  relax_step: 0,
  relax_steps: 0,
  evaluations: 0,
  fraction: 0,
  stop_reason: null,
  message: null,
  radius: 0,
  moved: false,
});

/**
 * The engine's signals, writable.
 * @typedef {{[K in keyof EngineSignals as EngineSignals[K] extends ReadonlySignal<any> ? K : never]:
 *   EngineSignals[K] extends ReadonlySignal<infer T> ? Signal<T> : never}} Store
 */

/** @returns {Store} */
export function createStore() {
  return {
    state: signal(emptyState()),
    description: signal(null),
    field: signal(null),
    grip: signal(null),
    fieldError: signal(null),
    progress: signal(idleProgress()),
    report: signal(null),
    timing: signal(null),
    backend: signal('starting'),
    adapter: signal(''),
    notice: signal(null),
    mesh: signal(null),
    meshing: signal(null),
    hover: signal(null),
    spot: signal(null),
    legend: signal(null),
    reveal: signal(null),
    status: signal('rest'),
    result: signal(null),
    trial: signal('none'),
    dragging: signal(false),
    revision: signal(0),
    lastDrag: signal(null),
    loading: signal(null),
    loadingError: signal(null),
    model: signal(null),
    image: signal(null),
    taken: signal(null),
    change: signal(null),
    valueFault: signal(null),
    frame: signal(0),
    turned: signal(0),
    theme: signal('light'),
  };
}

/** Changes a part of the shareable state. @param {Store} store @param {Partial<State>} patch */
export function change({ state }, patch) {
  state.value = { ...state.value, ...patch };
}

/**
 * Changes a part of the view in the state.
 * @param {Store} store
 * @param {Partial<ViewState>} patch
 */
export function changeView(store, patch) {
  change(store, { view: { ...store.state.value.view, ...patch } });
}

/** Shows all generation levels again, because a new surface is shown as it grows. @param {Store} store */
export function showAll(store) {
  const { level, step } = store.state.value.view;
  if (level !== null || step !== null) changeView(store, { level: null, step: null });
}

/** Returns the core's description of itself. @param {Store} store @throws before the core has loaded */
export function description({ description }) {
  if (!description.value) throw new Error('The core is not there yet.');
  return description.value;
}
