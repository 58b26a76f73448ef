/**
 * Loads models and files and samples them once they are solved. The state may name a built-in model before it is
 * solved; if solving fails, the state returns to the previous surface. A file enters the state only after it has been
 * solved.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { defaultState, fromPoints, modelOf } from '../share/state.js';
import { FILE_SURFACE, LARGEST_FILE_BYTES } from '../types.js';
import { PointsClient } from './client.js';

/**
 * @typedef {import('../store.js').Store} Store
 * @typedef {import('../types.js').State} State
 * @typedef {import('./client.js').Refusal} Refusal
 * @typedef {import('./client.js').WorkerLike} WorkerLike
 * @typedef {import('./protocol.js').Order} Order
 */
/**
 * The part of the state that determines the surface.
 * @typedef {Pick<State, 'surface' | 'formula' | 'parameters' | 'declared' | 'bounds'>} Shape
 */
/** @typedef {{grow?: boolean, fit?: boolean}} SampleOptions */

/** @param {string} surface @param {string} [formula] @returns {Shape} */
export const shapeOf = (surface, formula = '') => ({ surface, formula, parameters: {}, declared: [], bounds: null });

export class ModelLoader {
  /**
   * @param {object} options
   * @param {Store} options.store
   * @param {() => WorkerLike} options.spawn
   * @param {(options: SampleOptions) => void} options.sample  samples the present state
   */
  constructor({ store, spawn, sample }) {
    this.store = store;
    this.sample = sample;
    this.client = new PointsClient({
      spawn,
      onProgress: ({ stage, label, fraction }) => {
        const { loading } = store;
        if (loading.value) loading.value = { ...loading.value, stage, label, fraction };
      },
    });
    /** Key of the solved model of the file opened last. */
    this.fileKey = '';
    this.files = 0;
    /** The surface that was sampled last. @type {Shape | null} */
    this.last = null;
    /** Id of the current order. */
    this.orderId = 0;
  }

  get hasFile() {
    return this.fileKey !== '';
  }

  /** Returns the key of the state's model; undefined for a formula. */
  key() {
    const { surface } = this.store.state.value;
    if (!fromPoints(this.store.description.value, surface)) return undefined;
    return surface === FILE_SURFACE ? this.fileKey : surface;
  }

  /** Returns whether the state's surface can be sampled now. */
  ready() {
    const key = this.key();
    return key === undefined || this.client.get(key) !== undefined;
  }

  /** Records the state's surface, which is being sampled, as the one to return to. */
  settled() {
    const { surface, formula, parameters, declared, bounds } = this.store.state.value;
    this.last = { surface, formula, parameters, declared, bounds };
  }

  /** Returns the state; while its model is loading, the state with the previous surface. */
  present() {
    const { state } = this.store;
    return this.ready() ? state.value : { ...state.value, ...this.before() };
  }

  /** @returns {Shape} */
  before() {
    const { description } = this.store;
    if (this.last || !description.value) return this.last ?? shapeOf('');
    const { surface, formula } = defaultState(description.value);
    return shapeOf(surface, formula);
  }

  /** Starts solving the state's model and samples it once it is solved. @param {SampleOptions} options */
  async load(options) {
    const { state, loading, description } = this.store;
    const id = state.value.surface;
    const model = modelOf(description.value, id);
    if (!model || loading.value?.id === id) return;
    const done = await this.order(id, model.name, id, { model: id }, () => {
      if (state.value.surface === id) this.sample(options);
    });
    if (done || state.value.surface !== id || loading.value?.id === id) return;
    const nothing = this.last === null;
    state.value = { ...state.value, ...this.before() };
    if (nothing) this.sample(options);
  }

  /** @param {File} file */
  async openFile(file) {
    if (file.size > LARGEST_FILE_BYTES) {
      const mb = (/** @type {number} */ bytes) => Math.round(bytes / 1e6).toLocaleString();
      this.refused(FILE_SURFACE, file.name, {
        kind: 'too_large',
        message: `the file has ${mb(file.size)} MB; up to ${mb(LARGEST_FILE_BYTES)} MB are read`,
        line: null,
      });
      return;
    }
    this.files += 1;
    const key = `file ${this.files}`;
    const { state } = this.store;
    await this.order(FILE_SURFACE, file.name, key, { file }, () => {
      this.fileKey = key;
      state.value = { ...state.value, ...shapeOf(FILE_SURFACE) };
      this.sample({ grow: true, fit: true });
    });
  }

  /**
   * @param {string} id @param {string} name @param {string} key @param {Order} order
   * @param {() => void} done  called once the model is solved
   * @returns {Promise<boolean>} whether the model was solved
   */
  async order(id, name, key, order, done) {
    const { loading, loadingError } = this.store;
    this.orderId += 1;
    const mine = this.orderId;
    batch(() => {
      loadingError.value = null;
      loading.value = { id, name, stage: 'starting', label: 'Starting', fraction: 0 };
    });
    const outcome = await this.client.load(key, order);
    if (this.orderId !== mine) return false;
    // A batch, so that no effect runs between the end of the loading and the start of the run.
    batch(() => {
      loading.value = null;
      if ('solved' in outcome) done();
      else if ('refusal' in outcome) this.refused(id, name, outcome.refusal);
    });
    return 'solved' in outcome;
  }

  /** @param {string} id @param {string} name @param {Refusal} refusal */
  refused(id, name, { kind, message, line, details }) {
    const { loadingError, notice } = this.store;
    loadingError.value = { id, name, kind, message, line };
    notice.value = { id: 'file', kind: 'error', text: `${name}: ${message}`, ...(details ? { details } : {}) };
  }

  /** Gives up the current order. */
  cancel() {
    this.client.giveUp();
  }
}
