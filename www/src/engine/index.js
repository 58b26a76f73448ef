/**
 * The engine of the page: samples in a worker, draws on a canvas, keeps the state. The interface reads its signals and calls
 * its commands; it needs nothing else of this folder but the types.
 *
 * @module
 */
import { batch, effect } from '@preact/signals-core';
import { Columns } from './columns.js';
import { CAMERA_MS, installConsole } from './console.js';
import { ModelLoader, shapeOf } from './points/loader.js';
import { SamplingClient } from './sampling/client.js';
import { spawnSampler } from './sampling/spawn.js';
import { decode, encode } from './share/codec.js';
import {
  completeSettings,
  defaultState,
  fieldRequest,
  fromPoints,
  modelOf,
  sanitize,
  surfaceOf,
  validBounds,
  validSetting,
  validView,
} from './share/state.js';
import { createStore } from './store.js';
import { FILE_SURFACE } from './types.js';
import { BACKENDS } from './view/backends.js';
import { attachControls } from './view/controls.js';
import { Viewer } from './view/viewer.js';

/**
 * @typedef {import('./types.js').Engine} Engine
 * @typedef {import('./types.js').State} State
 * @typedef {import('./sampling/client.js').SampleRequest} SampleRequest
 */

/** After a drag has rested this long the full run is made, also when the control never says that it was let go. */
const REST_MS = 250;
/** After so long without a key the formula counts as written: the camera comes to its surface. */
const TYPING_MS = 900;
/** After so long without a key a name that may be the beginning of another counts as written. */
const NAME_MS = 1000;
/** The address follows the state at this pace; browsers refuse more than about 100 changes in half a minute. */
const ADDRESS_MS = 500;
/** Writing files is not part of the first picture: fetched once the sampler is there, so that it is there when it is wanted. */
const files = () => import('./share/exports.js');
/** Ceiling for particles that a person may confirm. */
const MOST_PARTICLES = 4_000_000;

/**
 * @param {{canvasHost: HTMLElement}} options  `canvasHost`, which is positioned, is filled with a canvas of its own size
 * @returns {Engine}
 */
export function createEngine({ canvasHost }) {
  const store = createStore();
  const columns = new Columns();
  const query = new URLSearchParams(location.search);
  const first = BACKENDS.find((kind) => kind === query.get('backend')) ?? null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let rest_timer;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let fit_timer;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let address_timer;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let camera_timer;
  /** The fragment that we wrote, to tell it from one that somebody typed. */
  let own_hash = location.hash;

  // ---- picture --------------------------------------------------------------------------------------------------------------

  canvasHost.tabIndex = Math.max(canvasHost.tabIndex, 0);

  const viewer = new Viewer(
    { host: canvasHost, columns, look: store.state.value.view, first },
    {
      onDevice(device) {
        const name = device.kind === 'canvas2d' ? 'canvas2d' : device.kind;
        batch(() => {
          store.backend.value = name;
          store.adapter.value = device.renderer.adapter();
          if (store.notice.value?.id === 'device-lost') {
            store.notice.value = { id: 'device-lost', kind: 'info', text: 'The graphics device was lost and is back.' };
          }
        });
        if (columns.count > device.renderer.max_particles()) {
          store.notice.value = {
            id: 'too-many-to-draw',
            kind: 'warn',
            text: `The picture shows the first ${device.renderer.max_particles()} particles; the figures and exports hold all of them.`,
          };
        }
      },
      onLost(kind, message) {
        store.notice.value = {
          id: 'device-lost',
          kind: 'warn',
          text: 'The graphics device was lost and is being opened again.',
          details: `${kind}: ${message}`,
        };
      },
      onFallback(kind, message) {
        // At the start this is the ordinary way down the list of back ends; later on it is news.
        if (store.backend.value !== 'starting') {
          store.notice.value = {
            id: 'fallback',
            kind: 'warn',
            text: `Drawing with ${kind === 'webgpu' ? 'WebGPU' : 'WebGL2'} failed; the picture is drawn another way.`,
            details: `${kind}: ${message}`,
          };
        }
      },
      onLegend(legend) {
        store.legend.value = legend;
      },
      onReveal(reveal) {
        store.reveal.value = reveal;
      },
      onCamera() {
        camera_timer ??= setTimeout(() => {
          camera_timer = undefined;
          store.state.value = {
            ...store.state.value,
            view: { ...store.state.value.view, camera: viewer.camera.state },
          };
        }, CAMERA_MS);
      },
    },
  );

  const detach = attachControls({
    host: canvasHost,
    camera: viewer.camera,
    currentView: () => viewer.currentView(),
    moved: () => viewer.moved(),
    fit: () => viewer.fit(),
    point(x, y, tapped) {
      const index = viewer.pick(x, y);
      if (index !== null || tapped || store.hover.value) showHover(index, x, y);
    },
    leave: () => showHover(null, 0, 0),
  });

  /** @param {number | null} index @param {number} x @param {number} y */
  function showHover(index, x, y) {
    if (index === null) {
      if (store.hover.value) store.hover.value = null;
    } else {
      const triple = (/** @type {Float32Array} */ column) =>
        /** @type {[number, number, number]} */ ([...column.subarray(3 * index, 3 * index + 3)]);
      store.hover.value = {
        index,
        x,
        y,
        level: columns.levels[index],
        parent: columns.parents[index] === 0xffffffff ? null : columns.parents[index],
        position: triple(columns.positions),
        normal: triple(columns.normals),
        radius: columns.radii[index],
        residual: columns.residual?.[index] ?? null,
        valence: columns.valence?.[index] ?? null,
        nearest: columns.nearest?.[index] ?? null,
      };
    }
    if (viewer.look.highlight !== (index ?? -1)) viewer.set({ highlight: index ?? -1 });
  }

  // ---- sampling -------------------------------------------------------------------------------------------------------------

  const sampling = new SamplingClient({
    store,
    columns,
    picture: viewer,
    spawn: /** @type {() => any} */ (spawnSampler),
    whole: () => request({}),
    solved: (key) => loader.client.get(key),
    onReady() {
      void loadUrl(location.hash, true);
      files().catch(() => {});
    },
    onAsk(predicted, asked) {
      const limit = Number(asked.settings.max_particles);
      const raised = Math.min(MOST_PARTICLES, Math.ceil(predicted * 1.1));
      store.notice.value = {
        id: 'size',
        kind: 'warn',
        text: `About ${predicted.toLocaleString()} particles would be needed; the limit is ${limit.toLocaleString()}.`,
        action: {
          label: 'Sample them anyway',
          run() {
            commands.dismissNotice();
            change({
              settings: {
                ...store.state.value.settings,
                max_particles: validSetting(description(), 'max_particles', raised) ?? limit,
              },
            });
            sampling.sample(request({ confirmed: true, grow: true }));
          },
        },
      };
    },
  });

  const loader = new ModelLoader({
    store,
    spawn: () =>
      /** @type {any} */ (
        new Worker(new URL('./points/worker.js', import.meta.url), { type: 'module', name: 'points' })
      ),
    sample: (options) => resample(false, options),
  });

  const description = () => {
    const d = store.description.value;
    if (!d) throw new Error('The core is not there yet.');
    return d;
  };

  /** @param {Partial<SampleRequest>} options @returns {SampleRequest} */
  function request(options) {
    const d = description();
    const state = loader.present();
    return {
      kind: 'sample',
      field: fieldRequest(state, d, loader.key()),
      settings: completeSettings(d, state.settings),
      grow: false,
      live: false,
      fit: false,
      ...options,
    };
  }

  /** @param {Partial<State>} patch */
  function change(patch) {
    store.state.value = { ...store.state.value, ...patch };
  }

  /** Samples the state as it is now: live while a control is dragged, whole once it rests. @param {boolean} live @param {Partial<SampleRequest>} [options] */
  function resample(live, options = {}) {
    clearTimeout(rest_timer);
    if (!store.description.value) return;
    if (!loader.ready()) {
      void loader.load(options);
      return;
    }
    loader.settled();
    if (!live) {
      sampling.sample(request(options));
      return;
    }
    sampling.sampleLive(request({}), diagonal());
    rest_timer = setTimeout(() => sampling.sample(request({})), REST_MS);
  }

  /** Diagonal of the clip box in force. */
  function diagonal() {
    const bounds = store.state.value.bounds ?? store.field.value?.bounds;
    return bounds ? Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k])) : 0;
  }

  // ---- state in the address -------------------------------------------------------------------------------------------------

  /** @param {string} hash @param {boolean} [initial] */
  async function loadUrl(hash, initial = false) {
    const d = description();
    const { state, reset, problem } = await decode(hash, d, loader.has_file);
    if (problem) {
      store.notice.value = {
        id: 'link',
        kind: 'warn',
        text: `${problem} ${initial ? 'This is the standard surface instead.' : 'Nothing was changed.'}`,
      };
      if (!initial) return;
    } else if (reset.length) {
      store.notice.value = {
        id: 'link',
        kind: 'warn',
        text: `The link was read, except for: ${[...new Set(reset)].join(', ')}.`,
      };
    }
    applyState(state);
  }

  /** @param {State} state  a valid one */
  function applyState(state) {
    store.state.value = state;
    const surface = surfaceOf(store.description.value, state.surface);
    const bounds = state.bounds ?? surface?.bounds;
    if (bounds) viewer.setBounds(bounds);
    viewer.camera.set(state.view.camera);
    if (state.view.camera.fit && loader.ready()) {
      viewer.fit(true);
    }
    showLook();
    // Where the link's surface cannot be had, the camera comes back to the one that stays.
    written_ms = performance.now();
    choose({ grow: true, fit: state.view.camera.fit });
  }

  /** Samples another surface: what was on its way is no longer wanted. @param {{grow?: boolean, fit?: boolean}} [options] */
  function choose(options) {
    store.loadingError.value = null;
    if (store.loading.value && store.loading.value.id !== store.state.value.surface) loader.cancel();
    resample(false, options);
  }

  function writeAddress() {
    clearTimeout(address_timer);
    address_timer = setTimeout(async () => {
      if (!store.description.value) return;
      const hash = await encode(store.state.value, store.description.value);
      if (hash === own_hash) return;
      own_hash = hash;
      history.replaceState(history.state, '', hash || location.pathname + location.search);
    }, ADDRESS_MS);
  }

  const onHashChange = () => {
    if (location.hash === own_hash) return;
    own_hash = location.hash;
    if (store.description.value) void loadUrl(location.hash);
  };
  addEventListener('hashchange', onHashChange);

  // ---- how it looks -----------------------------------------------------------------------------------------------------------

  const dark = matchMedia('(prefers-color-scheme: dark)');
  function showLook() {
    const { view, bounds } = store.state.value;
    const theme = view.theme === 'auto' ? (dark.matches ? 'dark' : 'light') : view.theme;
    store.theme.value = theme;
    const box = bounds ?? store.field.value?.bounds ?? null;
    const solved =
      view.points && store.field.value?.kind === 'points'
        ? loader.client.get(sampling.accepted?.field.points)
        : undefined;
    viewer.set({
      colour: view.colour,
      size: view.size,
      theme,
      box: view.box || store.empty.value ? box : null,
      points: solved?.centres ?? null,
      level: view.level,
    });
    sampling.showCurvature(view.colour === 'curvature');
  }
  dark.addEventListener('change', showLook);

  /** When the formula was changed or a link read, until the camera comes to the surface. */
  let written_ms = NaN;
  /** The camera shows the whole box, for want of a surface. */
  let box_shown = false;
  const effects = [
    effect(() => {
      // The whole state is worth an address.
      if (store.state.value) writeAddress();
    }),
    effect(() => {
      const field = store.field.value;
      if (field) viewer.setBounds(field.bounds);
      if (store.empty.value || field) showLookLater();
    }),
    effect(() => {
      viewer.growing = store.busy.value;
    }),
    effect(() => {
      // Also where the last word was a mistake, or has no surface: what stays may be a surface typed on the way to it.
      const rests = () => !store.busy.value && (store.report.value !== null || store.empty.value);
      if (!rests() || Number.isNaN(written_ms)) return;
      clearTimeout(fit_timer);
      // Once the typing rests: the picture stands still meanwhile.
      fit_timer = setTimeout(
        () => {
          if (!rests()) return;
          written_ms = NaN;
          if (viewer.camera.state.fit) viewer.fit();
        },
        written_ms + TYPING_MS - performance.now(),
      );
    }),
    effect(() => {
      // Where there is no surface the box is all there is to see; once there is one again, the camera comes back to it.
      const [none, rests] = [store.empty.value && columns.count === 0, !store.busy.value && !store.progress.value.live];
      if (!rests || none === box_shown) return;
      box_shown = none;
      queueMicrotask(() => {
        showLook();
        if (viewer.camera.state.fit) viewer.fit();
      });
    }),
  ];
  /** What is sampled anew is seen growing, all of it. */
  function allLevels() {
    if (store.state.value.view.level !== null) commands.setView({ level: null });
  }
  function showLookLater() {
    queueMicrotask(showLook);
  }

  // ---- commands ---------------------------------------------------------------------------------------------------------------

  /** @type {import('./types.js').EngineCommands} */
  const commands = {
    setSurface(id) {
      const surface = surfaceOf(store.description.value, id);
      if (!surface && !modelOf(store.description.value, id) && !(id === FILE_SURFACE && loader.has_file)) return;
      allLevels();
      change(shapeOf(id, surface?.formula));
      choose({ grow: true, fit: true });
    },
    openFile(file) {
      // A formula that waits for its end would take the file's place.
      clearTimeout(rest_timer);
      return loader.openFile(file);
    },
    cancelLoading: () => loader.cancel(),
    setFormula(text, { unfinished = false } = {}) {
      const { surface, formula } = store.state.value;
      if (text === formula) return;
      // A model has no formula to change: the one typed starts from the default surface.
      if (fromPoints(store.description.value, surface)) change(shapeOf(description().default_surface, text));
      else change({ formula: text });
      written_ms = performance.now();
      clearTimeout(fit_timer);
      clearTimeout(rest_timer);
      if (unfinished) rest_timer = setTimeout(choose, NAME_MS);
      else choose();
    },
    setParameter(name, value, { live = false } = {}) {
      if (!Number.isFinite(value)) return;
      change({ parameters: { ...store.state.value.parameters, [name]: value } });
      resample(live);
    },
    resetParameter(name) {
      const { [name]: _, ...parameters } = store.state.value.parameters;
      change({ parameters });
      resample(false);
    },
    declareParameter(name) {
      const { declared } = store.state.value;
      if (declared.some((p) => p.name === name)) return;
      change({ declared: [...declared, { name, label: name, value: 1, min: -2, max: 2, step: 0.01 }] });
      resample(false);
    },
    setBounds(bounds, { live = false } = {}) {
      const valid = bounds === null ? null : validBounds(bounds);
      if (valid === undefined) return;
      change({ bounds: valid });
      showLook();
      resample(live);
    },
    setSetting(name, value, { live = false } = {}) {
      const valid = store.description.value ? validSetting(store.description.value, name, value) : undefined;
      if (valid === undefined) return;
      change({ settings: { ...store.state.value.settings, [name]: valid } });
      resample(live);
    },
    resetSetting(name) {
      const { [name]: _, ...settings } = store.state.value.settings;
      change({ settings });
      resample(false);
    },
    restore(shape) {
      const another = shape.surface !== store.state.value.surface;
      if (another) allLevels();
      change(shape);
      showLook();
      choose({ grow: another, fit: another });
    },
    run() {
      allLevels();
      resample(false, { grow: true });
    },
    stop() {
      clearTimeout(rest_timer);
      loader.cancel();
      sampling.stop();
    },
    generateOnly() {
      const settings = { ...completeSettings(description(), store.state.value.settings), relax_steps: 0 };
      resample(false, { grow: true, settings });
    },
    relax(steps) {
      if (steps > 0) sampling.relax(Math.min(1000, Math.round(steps)));
    },
    setView(patch) {
      const view = validView(/** @type {Record<string, unknown>} */ (patch), store.state.value.view);
      if (patch.camera) viewer.camera.set(view.camera);
      change({ view });
      showLook();
      if (store.hover.value && store.hover.value.level > (view.level ?? Infinity)) showHover(null, 0, 0);
    },
    fit: () => viewer.fit(),
    zoom(factor) {
      viewer.camera.zoom(factor);
      viewer.moved();
    },
    orbit(dx_rad, dy_rad) {
      viewer.camera.rest();
      viewer.camera.orbit(dx_rad, dy_rad);
      viewer.moved();
    },
    setInsets: (insets) => viewer.set({ insets }),
    async shareUrl() {
      if (store.state.value.surface === FILE_SURFACE) {
        store.notice.value = {
          id: 'share-file',
          kind: 'info',
          text: `A link cannot hold the points of ${store.model.value?.name ?? 'a file'}: it shows the standard surface with these settings. Send the file along.`,
        };
      }
      return location.origin + location.pathname + (await encode(store.state.value, description()));
    },
    loadUrl: (hash) => loadUrl(hash),
    async savePng({ width, height, transparent = false } = {}) {
      const { LARGEST_PICTURE_PX, png } = await files();
      const side = (/** @type {number | undefined} */ wanted, /** @type {number} */ own) =>
        Math.min(LARGEST_PICTURE_PX, Math.max(1, Math.round(wanted ?? own)));
      const picture = await viewer.pixels(
        side(width, viewer.screen.width),
        side(height, viewer.screen.height),
        transparent,
      );
      return png(picture.width, picture.height, picture.pixels);
    },
    async exportFile(format) {
      if (!sampling.shown) throw new Error('There is no surface.');
      const { field } = sampling.shown.request;
      const model = field.points && loader.client.get(field.points)?.info.info;
      const what = model
        ? `${model.name}, interpolated from ${model.centres} points`
        : `f = ${field.formula ?? surfaceOf(description(), field.surface ?? '')?.formula}`;
      const { csv, ply } = await files();
      return format === 'csv' ? csv(columns) : ply(columns, { comment: `Marching Particles, ${what}` });
    },
    dismissNotice() {
      store.notice.value = null;
    },
    pick: (x, y) => viewer.pick(x, y),
    destroy() {
      for (const timer of [rest_timer, fit_timer, address_timer, camera_timer]) clearTimeout(timer);
      for (const stop of effects) stop();
      removeEventListener('hashchange', onHashChange);
      dark.removeEventListener('change', showLook);
      detach();
      viewer.destroy();
      loader.cancel();
      sampling.supervisor.stop();
    },
  };

  const engine = { ...store, columns, ...commands };
  installConsole({
    engine,
    viewer,
    sampling,
    columns,
    applyState(patch) {
      const d = description();
      const now = store.state.value;
      const another =
        typeof patch.surface === 'string'
          ? patch.surface !== now.surface
          : typeof patch.formula === 'string' && fromPoints(d, now.surface);
      const base = another ? { ...defaultState(d), view: now.view, settings: now.settings } : now;
      const { state, reset } = sanitize(
        {
          ...base,
          formula: undefined,
          ...(patch.surface ? {} : { formula: now.formula }),
          ...patch,
          view: { ...now.view, .../** @type {object} */ (patch.view ?? {}) },
        },
        d,
        loader.has_file,
      );
      applyState(state);
      return reset;
    },
  });
  // A dark page is dark from the start.
  showLook();
  sampling.start();
  void viewer.start();
  return engine;
}
