/**
 * Loads models and files, and samples them once models are solved and images or meshes opened. The state may name a
 * built-in model before it is solved; if solving fails, the state returns to the previous surface. A file enters the
 * state only once it is solved or opened.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { FILE_SURFACE, IMAGE_TYPES, MESH_TYPES } from '../constants.js';
import { scanOf } from '../scans.js';
import { defaultState, emptyState, freshShape, fromPoints, modelOf } from '../share/state.js';
import { PointsClient } from './client.js';

/**
 * @import { KeyedFile, Opened } from '../files/types.js'
 * @import { ImageFacts, SampleKind, Shape } from '../types.js'
 * @import { Ending } from './client.js'
 * @import { LoaderOptions, Refusal, Wanted } from './types.js'
 */

/** Key of a solved model. @param {string} points  of the model or the file @param {number | null} centres */
const keyOf = (points, centres) => (centres === null ? points : `${points}, ${centres} centres`);

/** Used without a worker that opens files. @type {NonNullable<LoaderOptions['openGiven']>} */
const NO_OPENER = () => Promise.resolve({ ok: false, kind: 'no_faces', message: 'there is no opener' });

/** An image with more different values is first treated as a grey-value image. */
const MOST_BODIES = 32;

/** Whether the name of a file ends with one of these types. @param {string} name @param {string} types */
const isOf = (name, types) => types.split(',').some((type) => name.toLowerCase().endsWith(type));

/**
 * The initial parameters for a file's surface: for labels the one of the largest body, else none.
 * @param {ImageFacts | null} facts @returns {Shape['parameters']}
 */
function beginningOf(facts) {
  const labels = facts?.labels ?? [];
  if (labels.length === 0 || labels.length > MOST_BODIES) return {};
  const bodies = labels.filter(({ value }) => value !== 0);
  return { label: bodies.reduce((largest, other) => (other.voxels > largest.voxels ? other : largest)).value };
}

export class ModelLoader {
  #store;
  #sample;
  #openGiven;
  #stopOpening;

  /** The last opened file, and the prefix of its models' keys. @type {{file: File, key: string} | null} */
  #opened;
  /**
   * Opened images and meshes by key.
   * @type {Map<string, {file: KeyedFile, facts: ImageFacts | null}>}
   */
  #given = new Map();
  #files;

  /** The last sampled surface. @type {Shape | null} */
  #last;

  /** Id of the current order. */
  #orderId;

  /** @param {LoaderOptions} options */
  constructor({ store, spawn, sample, openGiven = NO_OPENER, stopOpening = () => {} }) {
    this.#store = store;
    this.#sample = sample;
    this.#openGiven = openGiven;
    this.#stopOpening = stopOpening;
    this.client = new PointsClient({
      spawn,
      onProgress: ({ label, fraction }) => this.#tell(label, fraction),
    });
    this.#opened = null;
    this.#files = 0;
    /** Key of the model that is being solved; else empty. */
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
    return this.#given.has(own) || scanOf(own) ? own : keyOf(own, centres);
  }

  /** Whether the state's surface can be sampled now. */
  ready() {
    const key = this.key();
    return key === undefined || this.solved(key) !== undefined;
  }

  /** Returns the solved model or opened file for a key. @param {string} key */
  solved(key) {
    return this.#given.get(key) ?? this.client.get(key);
  }

  /** The initial parameters for the last opened file. @returns {Shape['parameters']} */
  beginning() {
    const known = this.#given.get(this.#opened?.key ?? '');
    return known ? beginningOf(known.facts) : {};
  }

  /** Records the state's surface, which is now being sampled, as the one to return to. */
  settled() {
    const { v: _, view: __, ...shape } = this.#store.state.value;
    this.#last = shape;
    this.#store.image.value = this.#given.get(this.key() ?? '')?.facts ?? null;
  }

  /** Returns the state, but with the previous surface while its model is loading. */
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
   * Returns what must be solved for the state; null for a formula.
   * @returns {Wanted | null}
   */
  #wanted() {
    const { surface, centres } = this.#store.state.value;
    const model = modelOf(this.#store.description.value, surface);
    const scan = scanOf(surface);
    if (scan) return { id: surface, name: scan.name, order: null };
    if (model) return { id: surface, name: model.name, order: { model: surface, centres } };
    if (surface !== FILE_SURFACE || !this.#opened || this.#given.has(this.#opened.key)) return null;
    const { file } = this.#opened;
    return { id: surface, name: file.name, order: { file, centres } };
  }

  /** @param {File} file @param {File[]} [beside]  one of which may hold the voxels of an image */
  async openFile(file, beside = []) {
    if (isOf(file.name, IMAGE_TYPES)) {
      await this.#openFor('image', file, { beside });
      return;
    }
    const why = isOf(file.name, MESH_TYPES) ? await this.#openFor('mesh', file, { elsePoints: true }) : null;
    if (why === undefined) return;
    await this.#openPoints(file, null);
    if (why && why.kind !== 'no_faces' && this.#store.loadingError.value === null)
      this.#store.notice.value = {
        id: 'taken',
        kind: 'info',
        text: `${file.name} was taken for points: ${why.message}`,
      };
  }

  /** Uses the last opened mesh file as a surface or as points. @param {'surface' | 'points'} what */
  async takeFor(what) {
    const file = this.#opened?.file;
    if (!file || this.#store.taken.value === what) return;
    if (what === 'points') await this.#openPoints(file, 'points');
    else await this.#openFor('mesh', file);
  }

  /** @param {File} file @param {'points' | null} taken  whether it could be taken for a surface, too */
  async #openPoints(file, taken) {
    // Without a core, only the solver can refuse a file that is too large.
    const most = this.#store.description.value?.limits.file_bytes ?? Number.POSITIVE_INFINITY;
    if (file.size > most) {
      const mb = (/** @type {number} */ bytes) => Math.round(bytes / 1e6).toLocaleString('en');
      this.#store.loading.value = null;
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
      this.#store.taken.value = taken;
      const { value: now } = state;
      state.value = { ...now, ...freshShape(this.#store.description.value, now.settings, FILE_SURFACE) };
      this.#sample('new');
    });
  }

  /**
   * Opens a file as an image or a mesh and samples its surface. With `elsePoints` it returns why a mesh has no surface,
   * instead of showing the reason.
   * @param {KeyedFile['as']} as @param {File} file
   * @param {{beside?: File[], elsePoints?: boolean, step?: number}} [options]
   * @returns {Promise<Refusal | undefined>}
   */
  async #openFor(as, file, { beside = [], elsePoints = false, step = 1 } = {}) {
    this.cancel();
    this.#files += 1;
    const others = beside.map((other) => ({ name: other.name, file: other }));
    const given = { as, key: `file ${this.#files}`, name: file.name, file, beside: others, step };
    /** @type {Refusal | undefined} */
    let refused;
    const load = async () => {
      const ending = await this.#open(given, (coarser) => this.#openFor(as, file, { beside, step: coarser }));
      if (!elsePoints || !('refusal' in ending)) return ending;
      refused = ending.refusal;
      return { goesOn: /** @type {const} */ (true) };
    };
    const order = this.#order({ id: FILE_SURFACE, name: file.name }, given.key, load, () => {
      this.#opened = { file, key: given.key };
      const { state, description, taken } = this.#store;
      taken.value = as === 'mesh' ? 'surface' : null;
      const { value: now } = state;
      const fresh = freshShape(description.value, now.settings, FILE_SURFACE);
      state.value = { ...now, ...fresh, parameters: this.beginning() };
      this.#sample('new');
    });
    const mine = this.#orderId;
    await order;
    return this.#orderId === mine ? refused : undefined;
  }

  /** Computes an image of the gallery and opens it. @param {string} key @param {Pick<Wanted, 'id' | 'name'>} scan */
  async #computed(key, { id, name }) {
    const { scanFile } = await import('../files/scans.js');
    return this.#open({ as: 'image', key, name, file: scanFile(id), beside: [] });
  }

  /**
   * @param {KeyedFile} file @param {(step: number) => void} [again]  opens it with fewer voxels
   * @returns {Promise<Ending | { opened: Opened }>}
   */
  async #open(file, again) {
    const opened = await this.#openGiven(file, (label, fraction) => this.#tell(label, fraction));
    if (!opened) return { givenUp: true };
    if (!opened.ok) {
      const { kind, message, step } = opened;
      const action = step && again ? { label: `Keep one voxel in ${step}`, run: () => again(step) } : undefined;
      return { refusal: { kind, message, action } };
    }
    this.#given.set(file.key, { file, facts: opened.facts });
    return { opened };
  }

  /** @param {string} label @param {number} fraction */
  #tell(label, fraction) {
    const { loading } = this.#store;
    if (loading.value) loading.value = { ...loading.value, label, fraction };
  }

  /**
   * @param {Pick<Wanted, 'id' | 'name'>} wanted @param {string} key
   * @param {() => Promise<Ending | { opened: Opened } | { goesOn: true }>} load  `goesOn`: another order follows
   * @param {() => void} done  called when the model is solved or the file is open
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
    // A batch, so that no effect runs between the end of loading and the start of the run.
    batch(() => {
      if (!('goesOn' in outcome)) loading.value = null;
      if ('solved' in outcome || 'opened' in outcome) done();
      else if ('refusal' in outcome) this.#refused(id, name, outcome.refusal);
    });
    return 'solved' in outcome || 'opened' in outcome;
  }

  /** @param {string} id @param {string} name @param {Refusal} refusal */
  #refused(id, name, { kind, message, details, action }) {
    const { loadingError, notice } = this.#store;
    loadingError.value = { id, name, kind, message };
    notice.value = {
      id: 'file',
      kind: 'error',
      text: `${name}: ${message}`,
      ...(details ? { details } : {}),
      ...(action ? { action } : {}),
    };
  }

  /** Cancels the current order. */
  cancel() {
    this.client.giveUp();
    this.#stopOpening();
  }
}
