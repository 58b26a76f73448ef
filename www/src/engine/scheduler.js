/**
 * Turns the state into requests to the sampler and decides when to send them.
 *
 * @module
 */
import { TYPING_MS } from './constants.js';
import { ModelLoader } from './points/loader.js';
import { Sampler } from './sampling/sampler.js';
import { spawnSampler } from './sampling/spawn.js';
import { completeSettings, fieldRequest, validSetting } from './share/state.js';
import { change, description } from './store.js';

/**
 * @import { Pulled, RunOptions, SchedulerOptions } from './parts.js'
 * @import { SampleRequest } from './sampling/types.js'
 * @import { SampleKind } from './types.js'
 */

/** Pause in a drag after which the full run starts, even if the control did not report its release. */
const REST_MS = 250;
/** @returns {any} */
const spawnSolver = () =>
  new Worker(new URL('./points/worker.js', import.meta.url), { type: 'module', name: 'points' });

export class Scheduler {
  /**
   * Timer for the run that starts when a control or the typing pauses.
   * @type {ReturnType<typeof setTimeout> | undefined}
   */
  #timer;

  /** @param {SchedulerOptions} parts */
  constructor({ store, columns, picture, onReady }) {
    this.store = store;
    this.#timer = undefined;
    this.loader = new ModelLoader({
      store,
      spawn: spawnSolver,
      sample: (kind) => this.resample({ kind }),
      openGiven: (file, onProgress) => this.sampling.client.openFile(file, onProgress),
      stopOpening: () => this.sampling.client.stopOpening(),
    });
    this.sampling = new Sampler({
      store,
      columns,
      picture,
      spawn: spawnSampler,
      whole: () => this.#request(),
      solved: (key) => this.loader.solved(key),
      onReady,
      onAsk: (predicted, asked) => this.#askSize(predicted, asked),
    });
  }

  /**
   * Returns the request that samples the current state, or the surface that is being pulled.
   * @param {RunOptions} [options]
   * @returns {SampleRequest}
   */
  #request({ kind = 'change', pulled, settings: given } = {}) {
    const { loader } = this;
    const about = description(this.store);
    const state = loader.present();
    const isMesh = this.store.meshing.value !== null;
    const own = completeSettings(about, isMesh ? { ...state.settings, method: 'refined' } : state.settings);
    const settings = given ?? own;
    const follows = state.view.flow && (kind === 'move' || kind === 'rest');
    return {
      kind,
      field: { ...fieldRequest(state, about, loader.key()), ...pulled },
      settings,
      following: follows ? [settings] : [],
    };
  }

  /** Samples the current state. @param {RunOptions} [options] */
  resample(options = {}) {
    if (!this.#begin(options.kind)) return;
    const request = this.#request(options);
    // The answer tells when a pull has ended.
    if (options.pulled) this.sampling.submit(request);
    else this.sampling.sample(request);
  }

  /**
   * Samples the current state during a drag, coarsely if necessary, and fully once the drag pauses.
   * @param {Pulled} [pulled]
   */
  resampleLive(pulled) {
    if (!this.#begin()) return;
    this.sampling.sampleLive(this.#request({ pulled }), this.#diagonal());
    this.#timer = setTimeout(() => this.sampling.sample(this.#request({ kind: 'rest', pulled })), REST_MS);
  }

  /**
   * Samples another surface. A model that is loading for another choice is cancelled.
   * @param {SampleKind} [kind]
   */
  choose(kind) {
    this.store.loadingError.value = null;
    if (this.loader.orderKey !== this.loader.key()) this.loader.cancel();
    this.resample({ kind });
  }

  /** Samples a typed formula once the typing pauses, unless another request comes first. */
  chooseTyped() {
    this.forgetLater();
    this.store.typing.value = true;
    this.#timer = setTimeout(() => this.choose('trial'), TYPING_MS);
  }

  /** Cancels a run that is waiting for a pause. */
  forgetLater() {
    clearTimeout(this.#timer);
    this.store.typing.value = false;
  }

  stop() {
    this.forgetLater();
    this.loader.cancel();
    this.sampling.stop();
  }

  /**
   * Whether the state can be sampled now. If its model is not solved yet, solving begins.
   * @param {SampleKind} [kind]
   */
  #begin(kind) {
    this.forgetLater();
    this.store.spot.value = null;
    const { loader } = this;
    if (!this.store.description.value) return false;
    if (!loader.ready()) {
      void loader.load(kind);
      return false;
    }
    loader.settled();
    return true;
  }

  /** Returns the diagonal of the current clip box. */
  #diagonal() {
    const { state, field } = this.store;
    const bounds = state.value.bounds ?? field.value?.bounds;
    return bounds ? Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k])) : 0;
  }

  /**
   * Asks the user to confirm a run with more particles than the limit.
   * @param {number} predicted
   * @param {SampleRequest} asked
   */
  #askSize(predicted, asked) {
    const { store } = this;
    const limit = Number(asked.settings.max_particles);
    const raised = Math.ceil(predicted * description(store).limits.count_room);
    store.notice.value = {
      id: 'size',
      kind: 'warn',
      text: `About ${predicted.toLocaleString('en')} particles would be needed; the limit is ${limit.toLocaleString('en')}.`,
      action: {
        label: 'Sample them anyway',
        run: () => {
          store.notice.value = null;
          const maxParticles = validSetting(description(store), 'max_particles', raised) ?? limit;
          change(store, { settings: { ...store.state.value.settings, max_particles: maxParticles } });
          this.sampling.sample(this.#request({ kind: 'agreed' }));
        },
      },
    };
  }

  close() {
    this.forgetLater();
    this.loader.cancel();
    this.sampling.close();
  }
}
