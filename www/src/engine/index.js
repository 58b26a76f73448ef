/**
 * The engine of the page: samples in a worker, draws on a canvas and keeps the state. The interface reads its signals
 * and calls its commands; otherwise it imports only types and constants from this folder.
 *
 * @module
 */
import { Columns } from './columns.js';
import { runCommands } from './commands/run.js';
import { fetchExports, shareCommands } from './commands/share.js';
import { inputCommands, surfaceCommands } from './commands/surface.js';
import { viewCommands } from './commands/view.js';
import { createDebug } from './debug.js';
import { Framing } from './framing.js';
import { keepLook } from './look.js';
import { createPicture } from './picture.js';
import { ModelLoader } from './points/loader.js';
import { Sampler } from './sampling/sampler.js';
import { spawnSampler } from './sampling/spawn.js';
import { surfaceOf } from './share/state.js';
import { createStore } from './store.js';

/**
 * @import { Parts } from './parts.js'
 * @import { Engine, EngineOptions } from './types.js'
 */

/** @returns {any} */
const spawnSolver = () =>
  new Worker(new URL('./points/worker.js', import.meta.url), { type: 'module', name: 'points' });

/**
 * Creates an engine that draws in an element of the page and begins with a state. It knows nothing of the page's
 * address or of other engines, so that one page can have several.
 * @param {EngineOptions} options
 * @returns {Engine}
 */
export function createEngine({ host, link = '', state = {}, backend = null }) {
  const store = createStore();
  const columns = new Columns();
  const picture = createPicture({ host, store, columns, first: backend });
  const { viewer } = picture;
  const loader = new ModelLoader({
    store,
    spawn: spawnSolver,
    sample: (kind) => sampler.resample({ kind }),
    openGiven: (file, onProgress) => sampler.client.openFile(file, onProgress),
    stopOpening: () => sampler.client.stopOpening(),
  });
  const sampler = new Sampler({
    store,
    columns,
    picture: viewer,
    models: loader,
    spawn: spawnSampler,
    onReady() {
      // A given state brings its own camera.
      viewer.opening = link === '' && Object.keys(state).length === 0;
      void engine.openLink(link, { initial: true, patch: state });
      fetchExports().catch(() => {});
    },
  });
  const framing = new Framing({ store, columns, viewer, keep: () => sampler.commit() });

  /** @type {Parts['adopt']} */
  function adopt(whole) {
    const bounds = whole.bounds ?? surfaceOf(store.description.value, whole.surface)?.bounds;
    if (bounds) viewer.setBounds(bounds);
    const { camera } = whole.view;
    viewer.camera.set(camera);
    store.state.value = whole;
    if (camera.fit && loader.ready()) viewer.fit(true);
    // If the new surface cannot be sampled, the camera fits the old one.
    framing.written({ typed: false });
    sampler.choose(camera.fit ? 'new' : 'grow');
  }

  /** @type {Parts} */
  const parts = { store, columns, picture, sampler, loader, framing, adopt };
  const closeLook = keepLook({ store, viewer, sampler, loader });
  /** @type {Engine} */
  const engine = {
    ...store,
    columns,
    ...surfaceCommands(parts),
    ...inputCommands(parts),
    ...runCommands(parts),
    ...viewCommands(parts),
    ...shareCommands(parts),
    lessonSurface() {
      const field = store.field.value;
      if (!field) return null;
      const { model, image, mesh, formula, parameters, bounds } = field;
      if (image || mesh) return null;
      if (!model) return { formula, parameters, bounds };
      const solved = loader.client.get(loader.key());
      return solved ? { system: solved.field, pulls: store.state.value.pulls, bounds } : null;
    },
    debug: createDebug(parts),
    destroy() {
      closeLook();
      for (const part of [framing, picture, sampler]) part.close();
    },
  };
  sampler.start();
  void viewer.start();
  return engine;
}
