/**
 * Loads models and files and samples them once they are solved. The state may name a built-in model before it is
 * solved; if solving fails, the state returns to the previous surface. A file enters the state only after it has been
 * solved.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { FILE_SURFACE } from '../constants.js';
import { defaultState, emptyState, freshShape, fromPoints, modelOf } from '../share/state.js';
import { PointsClient } from './client.js';

/**
 * @import { SampleKind, Shape } from '../types.js'
 * @import { LoaderOptions, Refusal, Wanted } from './types.js'
 */

/** Key of a solved model. @param {string} points  of the model or the file @param {number | null} centres */
const keyOf = (points, centres) => (centres === null ? points : `${points}, ${centres} centres`);

export class ModelLoader {
  #store;
  #sample;

  /** The file opened last, and the beginning of the keys of its models. @type {{file: File, key: string} | null} */
  #opened;
  #files;

  /** The surface that was sampled last. @type {Shape | null} */
  #last;

  /** Id of the current order. */
  #orderId;

  /** @param {LoaderOptions} options */
  constructor({ store, spawn, sample }) {
    this.#store = store;
    this.#sample = sample;
    this.client = new PointsClient({
      spawn,
      onProgress: ({ label, fraction }) => {
        const { loading } = store;
        if (loading.value) loading.value = { ...loading.value, label, fraction };
      },
    });
    this.#opened = null;
    this.#files = 0;
    /** Key of the model that is being solved; empty if none is. */
    this.orderKey = '';
    this.#last = null;
    this.#orderId = 0;
  }

  get hasFile() {
    return this.#opened !== null;
  }

  /** Returns the key of the state's model; undefined for a formula. */
  key() {
    const { surface, centres } = this.#store.state.value;
    if (!fromPoints(this.#store.description.value, surface)) return undefined;
    return keyOf(surface === FILE_SURFACE ? (this.#opened?.key ?? '') : surface, centres);
  }

  /** Returns whether the state's surface can be sampled now. */
  ready() {
    const key = this.key();
    return key === undefined || this.client.get(key) !== undefined;
  }

  /** Records the state's surface, which is being sampled, as the one to return to. */
  settled() {
    const { v: _, view: __, ...shape } = this.#store.state.value;
    this.#last = shape;
  }

  /** Returns the state; while its model is loading, the state with the previous surface. */
  present() {
    const { state } = this.#store;
    return this.ready() ? state.value : { ...state.value, ...this.#before() };
  }

  /** @returns {Shape} */
  #before() {
    const about = this.#store.description.value;
    const { v: _, view: __, ...first } = about ? defaultState(about) : emptyState();
    return this.#last ?? first;
  }

  /** Starts solving the state's model and samples it once it is solved. @param {SampleKind} [kind] */
  async load(kind) {
    const { state } = this.#store;
    const key = this.key();
    const wanted = this.#wanted();
    if (key === undefined || !wanted || this.orderKey === key) return;
    const done = await this.#order(wanted, key, () => {
      if (this.key() === key) this.#sample(kind);
    });
    if (done || this.key() !== key || this.orderKey === key) return;
    const nothing = this.#last === null;
    state.value = { ...state.value, ...this.#before() };
    if (nothing) this.#sample(kind);
  }

  /**
   * Returns what is to be solved for the state; null for a formula.
   * @returns {Wanted | null}
   */
  #wanted() {
    const { surface, centres } = this.#store.state.value;
    const model = modelOf(this.#store.description.value, surface);
    if (model) return { id: surface, name: model.name, order: { model: surface, centres } };
    if (surface !== FILE_SURFACE || !this.#opened) return null;
    const { file } = this.#opened;
    return { id: surface, name: file.name, order: { file, centres } };
  }

  /** @param {File} file */
  async openFile(file) {
    // Without a core the solver alone refuses what is too large.
    const most = this.#store.description.value?.limits.file_bytes ?? Number.POSITIVE_INFINITY;
    if (file.size > most) {
      const mb = (/** @type {number} */ bytes) => Math.round(bytes / 1e6).toLocaleString('en');
      this.#refused(FILE_SURFACE, file.name, {
        kind: 'too_large',
        message: `the file has ${mb(file.size)} MB; up to ${mb(most)} MB are read`,
      });
      return;
    }
    this.#files += 1;
    const key = `file ${this.#files}`;
    const { state } = this.#store;
    const wanted = { id: FILE_SURFACE, name: file.name, order: { file, centres: null } };
    await this.#order(wanted, keyOf(key, null), () => {
      this.#opened = { file, key };
      const { value: now } = state;
      state.value = { ...now, ...freshShape(this.#store.description.value, now.settings, FILE_SURFACE) };
      this.#sample('new');
    });
  }

  /**
   * @param {Wanted} wanted @param {string} key
   * @param {() => void} done  called once the model is solved
   * @returns whether the model was solved
   */
  async #order({ id, name, order }, key, done) {
    const { loading, loadingError } = this.#store;
    this.#orderId += 1;
    const mine = this.#orderId;
    this.orderKey = key;
    batch(() => {
      loadingError.value = null;
      loading.value = { id, name, label: 'Starting', fraction: 0 };
    });
    const outcome = await this.client.load(key, order);
    if (this.#orderId !== mine) return false;
    this.orderKey = '';
    // A batch, so that no effect runs between the end of the loading and the start of the run.
    batch(() => {
      loading.value = null;
      if ('solved' in outcome) done();
      else if ('refusal' in outcome) this.#refused(id, name, outcome.refusal);
    });
    return 'solved' in outcome;
  }

  /** @param {string} id @param {string} name @param {Refusal} refusal */
  #refused(id, name, { kind, message, details }) {
    const { loadingError, notice } = this.#store;
    loadingError.value = { id, name, kind, message };
    notice.value = { id: 'file', kind: 'error', text: `${name}: ${message}`, ...(details ? { details } : {}) };
  }

  /** Gives up the current order. */
  cancel() {
    this.client.giveUp();
  }
}
