/**
 * The engine's signals in their writable form. The interface sees them as read-only.
 *
 * @module
 */
import { signal } from '@preact/signals-core';
import { emptyState } from './share/state.js';

/** @typedef {import('./types.js').Progress} Progress */

/** @returns {Progress} */
export const idleProgress = () => ({
  run: 0,
  live: false,
  phase: 'idle',
  particles: 0,
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
 * @template T
 * @param {T} value
 * @returns {import('@preact/signals-core').Signal<T>}
 */
const cell = (value) => signal(value);

export function createStore() {
  return {
    state: cell(emptyState()),
    description: cell(/** @type {import('./types.js').Description | null} */ (null)),
    field: cell(/** @type {import('./types.js').FieldOk | null} */ (null)),
    fieldError: cell(/** @type {import('./types.js').FieldFault | null} */ (null)),
    progress: cell(idleProgress()),
    report: cell(/** @type {import('./types.js').Report | null} */ (null)),
    timing: cell(/** @type {import('./types.js').Timing | null} */ (null)),
    backend: cell(/** @type {import('./types.js').BackendName} */ ('starting')),
    adapter: cell(''),
    notice: cell(/** @type {import('./types.js').Notice | null} */ (null)),
    mesh: cell(/** @type {import('./types.js').MeshAnswer | null} */ (null)),
    hover: cell(/** @type {import('./types.js').Hover | null} */ (null)),
    spot: cell(/** @type {import('./types.js').Place | null} */ (null)),
    legend: cell(/** @type {import('./types.js').Legend | null} */ (null)),
    reveal: cell(/** @type {import('./types.js').Reveal | null} */ (null)),
    busy: cell(false),
    partial: cell(false),
    revision: cell(0),
    empty: cell(false),
    lastDrag: cell(/** @type {import('./types.js').LastDrag | null} */ (null)),
    loading: cell(/** @type {import('./types.js').Loading | null} */ (null)),
    loadingError: cell(/** @type {import('./types.js').LoadingError | null} */ (null)),
    model: cell(/** @type {import('./types.js').ModelInfo | null} */ (null)),
    frame: cell(0),
    theme: cell(/** @type {'light' | 'dark'} */ ('light')),
  };
}

/** @typedef {ReturnType<typeof createStore>} Store */

/** Changes a part of the shareable state. @param {Store} store @param {Partial<import('./types.js').State>} patch */
export function change({ state }, patch) {
  state.value = { ...state.value, ...patch };
}

/**
 * Changes a part of the view in the state.
 * @param {Store} store
 * @param {Partial<import('./types.js').ViewState>} patch
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
