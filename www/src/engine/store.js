/**
 * The engine's signals in their writable form. The interface sees them as read-only.
 *
 * @module
 */
import { signal } from '@preact/signals-core';
import { emptyState } from './share/state.js';

/**
 * @import { BackendName, Description, FieldFault, FieldOk, Hover, LastDrag, Legend, Loading } from './types.js'
 * @import { LoadingError, MeshAnswer, ModelInfo, Notice, Place, Progress, Report, Reveal, State } from './types.js'
 * @import { Timing, ViewState } from './types.js'
 * @import { Signal } from '@preact/signals-core'
 */

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
 * @returns {Signal<T>}
 */
const cell = (value) => signal(value);

export function createStore() {
  return {
    state: cell(emptyState()),
    description: cell(/** @type {Description | null} */ (null)),
    field: cell(/** @type {FieldOk | null} */ (null)),
    fieldError: cell(/** @type {FieldFault | null} */ (null)),
    progress: cell(idleProgress()),
    report: cell(/** @type {Report | null} */ (null)),
    timing: cell(/** @type {Timing | null} */ (null)),
    backend: cell(/** @type {BackendName} */ ('starting')),
    adapter: cell(''),
    notice: cell(/** @type {Notice | null} */ (null)),
    mesh: cell(/** @type {MeshAnswer | null} */ (null)),
    hover: cell(/** @type {Hover | null} */ (null)),
    spot: cell(/** @type {Place | null} */ (null)),
    legend: cell(/** @type {Legend | null} */ (null)),
    reveal: cell(/** @type {Reveal | null} */ (null)),
    busy: cell(false),
    partial: cell(false),
    revision: cell(0),
    empty: cell(false),
    lastDrag: cell(/** @type {LastDrag | null} */ (null)),
    loading: cell(/** @type {Loading | null} */ (null)),
    loadingError: cell(/** @type {LoadingError | null} */ (null)),
    model: cell(/** @type {ModelInfo | null} */ (null)),
    frame: cell(0),
    theme: cell(/** @type {'light' | 'dark'} */ ('light')),
  };
}

/** @typedef {ReturnType<typeof createStore>} Store */

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
