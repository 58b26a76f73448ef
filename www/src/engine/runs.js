/**
 * From the state to runs of the sampler: what is asked for, and when.
 *
 * @module
 */
import { ModelLoader } from './points/loader.js';
import { SamplingClient } from './sampling/client.js';
import { spawnSampler } from './sampling/spawn.js';
import { completeSettings, fieldRequest, validSetting } from './share/state.js';
import { change, description } from './store.js';

/**
 * @typedef {import('./sampling/run-state.js').SampleRequest} SampleRequest
 * @typedef {import('./store.js').Store} Store
 * @typedef {{grow?: boolean, fit?: boolean, settings?: import('./types.js').Settings}} RunOptions
 */

/** After a drag has rested this long the full run is made, also when the control never says that it was let go. */
const REST_MS = 250;
/** Ceiling for particles that a person may confirm. */
const MOST_PARTICLES = 4_000_000;

/** @returns {any} */
const spawnSolver = () =>
  new Worker(new URL('./points/worker.js', import.meta.url), { type: 'module', name: 'points' });

export class Runs {
  /**
   * @param {object} parts
   * @param {Store} parts.store
   * @param {import('./columns.js').Columns} parts.columns
   * @param {import('./sampling/presenter.js').Picture} parts.picture
   * @param {() => void} parts.onReady  the core is there for the first time
   */
  constructor({ store, columns, picture, onReady }) {
    this.store = store;
    /** The run that comes once a control or the typing rests. @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.loader = new ModelLoader({ store, spawn: spawnSolver, sample: (options) => this.resample(options) });
    this.sampling = new SamplingClient({
      store,
      columns,
      picture,
      spawn: () => /** @type {any} */ (spawnSampler()),
      whole: () => this.request(),
      solved: (key) => this.loader.client.get(key),
      onReady,
      onAsk: (predicted, asked) => this.askSize(predicted, asked),
    });
  }

  /** What is asked of the sampler for the state as it is. @param {Partial<SampleRequest>} [options] @returns {SampleRequest} */
  request(options = {}) {
    const { loader } = this;
    const about = description(this.store);
    const state = loader.present();
    return {
      kind: 'sample',
      field: fieldRequest(state, about, loader.key()),
      settings: completeSettings(about, state.settings),
      grow: false,
      live: false,
      fit: false,
      ...options,
    };
  }

  /** Samples the state as it is now. @param {RunOptions} [options] */
  resample(options = {}) {
    if (this.begin(options)) this.sampling.sample(this.request(options));
  }

  /** Samples the state while a control is dragged, coarse if it has to be, and whole once the control rests. */
  resampleLive() {
    if (!this.begin({})) return;
    this.sampling.sampleLive(this.request(), this.diagonal());
    this.timer = setTimeout(() => this.sampling.sample(this.request()), REST_MS);
  }

  /** Samples another surface: what was on its way is no longer wanted. @param {RunOptions} [options] */
  choose(options) {
    const { store } = this;
    store.loadingError.value = null;
    if (store.loading.value && store.loading.value.id !== store.state.value.surface) this.loader.cancel();
    this.resample(options);
  }

  /** The same after a pause, unless something else is asked for meanwhile. @param {number} pauseMs */
  chooseLater(pauseMs) {
    this.forgetLater();
    this.timer = setTimeout(() => this.choose(), pauseMs);
  }

  /** What was to come after a pause comes no more. */
  forgetLater() {
    clearTimeout(this.timer);
  }

  stop() {
    this.forgetLater();
    this.loader.cancel();
    this.sampling.stop();
  }

  /** Whether the state can be sampled now; where its model is not solved yet, it will be. @param {RunOptions} options */
  begin(options) {
    this.forgetLater();
    const { loader } = this;
    if (!this.store.description.value) return false;
    if (!loader.ready()) {
      void loader.load(options);
      return false;
    }
    loader.settled();
    return true;
  }

  /** Diagonal of the clip box in force. */
  diagonal() {
    const { state, field } = this.store;
    const bounds = state.value.bounds ?? field.value?.bounds;
    return bounds ? Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k])) : 0;
  }

  /** Asks whether more particles than agreed are wanted. @param {number} predicted @param {SampleRequest} asked */
  askSize(predicted, asked) {
    const { store } = this;
    const limit = Number(asked.settings.max_particles);
    const raised = Math.min(MOST_PARTICLES, Math.ceil(predicted * 1.1));
    store.notice.value = {
      id: 'size',
      kind: 'warn',
      text: `About ${predicted.toLocaleString()} particles would be needed; the limit is ${limit.toLocaleString()}.`,
      action: {
        label: 'Sample them anyway',
        run: () => {
          store.notice.value = null;
          const maxParticles = validSetting(description(store), 'max_particles', raised) ?? limit;
          change(store, { settings: { ...store.state.value.settings, max_particles: maxParticles } });
          this.sampling.sample(this.request({ confirmed: true, grow: true }));
        },
      },
    };
  }

  close() {
    this.forgetLater();
    this.loader.cancel();
    this.sampling.supervisor.stop();
  }
}
