/**
 * Loads models and files and samples them once they are solved, or opened if they are images. The state may name a
 * built-in model before it is solved; if solving fails, the state returns to the previous surface. A file enters the
 * state only after that.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { FILE_SURFACE, IMAGE_TYPES } from '../constants.js';
import { scanOf } from '../scans.js';
import { defaultState, emptyState, freshShape, fromPoints, modelOf } from '../share/state.js';
import { PointsClient } from './client.js';

/**
 * @import { KeyedImage, Opened } from '../images/types.js'
 * @import { ImageFacts, SampleKind, Shape } from '../types.js'
 * @import { Ending } from './client.js'
 * @import { LoaderOptions, Refusal, Wanted } from './types.js'
 */

/** Key of a solved model. @param {string} points  of the model or the file @param {number | null} centres */
const keyOf = (points, centres) => (centres === null ? points : `${points}, ${centres} centres`);

/** An image with more different values is taken for one of grey values at first. */
const MOST_BODIES = 32;

/** Whether the name of a file is that of an image. @param {string} name */
const isImageName = (name) => IMAGE_TYPES.split(',').some((type) => name.toLowerCase().endsWith(type));

/**
 * The parameters with which the surface of an image begins: of labels that of the largest body, else none.
 * @param {ImageFacts} facts @returns {Shape['parameters']}
 */
function beginningOf({ labels }) {
  if (labels.length === 0 || labels.length > MOST_BODIES) return {};
  const bodies = labels.filter(({ value }) => value !== 0);
  return { label: bodies.reduce((largest, other) => (other.voxels > largest.voxels ? other : largest)).value };
}

export class ModelLoader {
  #store;
  #sample;
  #openImage;
  #stopImage;

  /** The file opened last, and the beginning of the keys of its models. @type {{file: File, key: string} | null} */
  #opened;
  /** The images that were opened, by their keys. @type {Map<string, {image: KeyedImage, facts: ImageFacts}>} */
  #images = new Map();
  #files;

  /** The surface that was sampled last. @type {Shape | null} */
  #last;

  /** Id of the current order. */
  #orderId;

  /** @param {LoaderOptions} options */
  constructor({ store, spawn, sample, openImage = () => Promise.resolve(null), stopImage = () => {} }) {
    this.#store = store;
    this.#sample = sample;
    this.#openImage = openImage;
    this.#stopImage = stopImage;
    this.client = new PointsClient({
      spawn,
      onProgress: ({ label, fraction }) => this.#tell(label, fraction),
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
    const own = surface === FILE_SURFACE ? (this.#opened?.key ?? '') : surface;
    return this.#images.has(own) || scanOf(own) ? own : keyOf(own, centres);
  }

  /** Returns whether the state's surface can be sampled now. */
  ready() {
    const key = this.key();
    return key === undefined || this.solved(key) !== undefined;
  }

  /** Returns the solved model under this key, or the opened image. @param {string} key */
  solved(key) {
    return this.#images.get(key) ?? this.client.get(key);
  }

  /** The parameters with which the file opened last begins. @returns {Shape['parameters']} */
  beginning() {
    const known = this.#images.get(this.#opened?.key ?? '');
    return known ? beginningOf(known.facts) : {};
  }

  /** Records the state's surface, which is being sampled, as the one to return to. */
  settled() {
    const { v: _, view: __, ...shape } = this.#store.state.value;
    this.#last = shape;
    this.#store.image.value = this.#images.get(this.key() ?? '')?.facts ?? null;
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
    const { order } = wanted;
    const load = () => (order ? this.client.load(key, order) : this.#computed(key, wanted));
    const done = await this.#order(wanted, key, load, () => {
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
    const scan = scanOf(surface);
    if (scan) return { id: surface, name: scan.name, order: null };
    if (model) return { id: surface, name: model.name, order: { model: surface, centres } };
    if (surface !== FILE_SURFACE || !this.#opened || this.#images.has(this.#opened.key)) return null;
    const { file } = this.#opened;
    return { id: surface, name: file.name, order: { file, centres } };
  }

  /** @param {File} file @param {File[]} [beside]  one of which may hold the voxels of an image */
  async openFile(file, beside = []) {
    if (isImageName(file.name)) return this.#openImageFile(file, beside);
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
    const load = () => this.client.load(keyOf(key, null), { file, centres: null });
    await this.#order({ id: FILE_SURFACE, name: file.name }, keyOf(key, null), load, () => {
      this.#opened = { file, key };
      const { value: now } = state;
      state.value = { ...now, ...freshShape(this.#store.description.value, now.settings, FILE_SURFACE) };
      this.#sample('new');
    });
  }

  /** @param {File} file @param {File[]} beside */
  async #openImageFile(file, beside) {
    this.cancel();
    this.#files += 1;
    const others = beside.map((other) => ({ name: other.name, file: other }));
    const image = { key: `file ${this.#files}`, name: file.name, file, beside: others };
    await this.#order(
      { id: FILE_SURFACE, name: file.name },
      image.key,
      () => this.#open(image),
      () => {
        this.#opened = { file, key: image.key };
        const { state, description } = this.#store;
        const { value: now } = state;
        const fresh = freshShape(description.value, now.settings, FILE_SURFACE);
        state.value = { ...now, ...fresh, parameters: this.beginning() };
        this.#sample('new');
      },
    );
  }

  /** Computes an image of the gallery and opens it. @param {string} key @param {Pick<Wanted, 'id' | 'name'>} scan */
  async #computed(key, { id, name }) {
    const { scanFile } = await import('../images/scans.js');
    return this.#open({ key, name, file: scanFile(id), beside: [] });
  }

  /** @param {KeyedImage} image @returns {Promise<Ending | { opened: Opened }>} */
  async #open(image) {
    const opened = await this.#openImage(image, (label, fraction) => this.#tell(label, fraction));
    if (!opened) return { givenUp: true };
    if (!opened.ok) return { refusal: { kind: 'image', message: opened.message } };
    this.#images.set(image.key, { image, facts: opened.facts });
    return { opened };
  }

  /** @param {string} label @param {number} fraction */
  #tell(label, fraction) {
    const { loading } = this.#store;
    if (loading.value) loading.value = { ...loading.value, label, fraction };
  }

  /**
   * @param {Pick<Wanted, 'id' | 'name'>} wanted @param {string} key
   * @param {() => Promise<Ending | { opened: Opened }>} load
   * @param {() => void} done  called once the model is solved, or the image is open
   * @returns whether it is
   */
  async #order({ id, name }, key, load, done) {
    const { loading, loadingError } = this.#store;
    this.#orderId += 1;
    const mine = this.#orderId;
    this.orderKey = key;
    batch(() => {
      loadingError.value = null;
      loading.value = { id, name, label: 'Starting', fraction: 0 };
    });
    const outcome = await load();
    if (this.#orderId !== mine) return false;
    this.orderKey = '';
    // A batch, so that no effect runs between the end of the loading and the start of the run.
    batch(() => {
      loading.value = null;
      if ('solved' in outcome || 'opened' in outcome) done();
      else if ('refusal' in outcome) this.#refused(id, name, outcome.refusal);
    });
    return !('refusal' in outcome || 'givenUp' in outcome);
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
    this.#stopImage();
  }
}
