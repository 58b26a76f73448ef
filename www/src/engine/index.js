/**
 * The engine of the page samples in a worker, draws on a canvas and keeps the state. The interface reads its signals
 * and calls its commands. Apart from those, the interface imports only types and constants from this folder.
 *
 * @module
 */
import { Address } from './address.js';
import { Columns } from './columns.js';
import { runCommands } from './commands/run.js';
import { fetchExports, shareCommands } from './commands/share.js';
import { inputCommands, surfaceCommands } from './commands/surface.js';
import { viewCommands } from './commands/view.js';
import { installConsole } from './console.js';
import { Framing } from './framing.js';
import { Look } from './look.js';
import { createPicture } from './picture.js';
import { Runs } from './runs.js';
import { coreFetched } from './sampling/spawn.js';
import { mergeState, surfaceOf } from './share/state.js';
import { createStore, description } from './store.js';
import { BACKENDS } from './view/backends.js';

/**
 * The parts of the engine, on which its commands act.
 * @typedef {object} Parts
 * @property {import('./store.js').Store} store
 * @property {Columns} columns
 * @property {import('./picture.js').Picture} picture
 * @property {Runs} runs
 * @property {Look} look
 * @property {Framing} framing
 * @property {Address} address
 */

/**
 * @param {{canvasHost: HTMLElement}} options  `canvasHost` must be positioned; a canvas fills it
 * @returns {import('./types.js').Engine}
 */
export function createEngine({ canvasHost }) {
  const store = createStore();
  const columns = new Columns();
  const wanted = new URLSearchParams(location.search).get('backend');
  const first = BACKENDS.find((kind) => kind === wanted) ?? null;

  const picture = createPicture({ host: canvasHost, store, columns, first });
  const { viewer } = picture;
  const runs = new Runs({
    store,
    columns,
    picture: viewer,
    onReady() {
      // A link brings its own camera.
      viewer.opening = location.hash === '';
      void address.load(location.hash, true);
      fetchExports().catch(() => {});
    },
  });
  const address = new Address({ store, hasFile: () => runs.loader.hasFile, apply: applyState });
  const look = new Look({ store, viewer, runs });
  const framing = new Framing({ store, columns, viewer, look });

  /** Adopts a whole state and samples it. @param {import('./types.js').State} state  a valid state */
  function applyState(state) {
    store.state.value = state;
    const bounds = state.bounds ?? surfaceOf(store.description.value, state.surface)?.bounds;
    if (bounds) viewer.setBounds(bounds);
    const { camera } = state.view;
    viewer.camera.set(camera);
    if (camera.fit && runs.loader.ready()) viewer.fit(true);
    look.show();
    // If the link's surface cannot be sampled, the camera fits the surface that stays.
    framing.written({ typed: false });
    runs.choose({ grow: true, fit: camera.fit });
  }

  /** @type {Parts} */
  const parts = { store, columns, picture, runs, look, framing, address };
  const engine = {
    ...store,
    columns,
    ...surfaceCommands(parts),
    ...inputCommands(parts),
    ...runCommands(parts),
    ...viewCommands(parts),
    ...shareCommands(parts),
    /** @type {import('./types.js').EngineCommands['openLesson']} */
    async openLesson(options) {
      const { LessonClient } = await import('./lesson/client.js');
      return new LessonClient(options);
    },
    lessonSurface() {
      const field = store.field.value;
      if (!field) return null;
      const { kind, formula, parameters, bounds } = field;
      if (kind === 'formula') return { formula, parameters, bounds };
      const solved = runs.loader.client.get(runs.loader.key());
      return solved ? { system: solved.field, bounds } : null;
    },
    destroy() {
      for (const part of [address, look, framing, picture, runs]) part.close();
    },
  };
  installConsole({
    engine,
    viewer,
    sampling: runs.sampling,
    columns,
    applyState(patch) {
      const { state, reset } = mergeState(store.state.value, patch, description(store), runs.loader.hasFile);
      applyState(state);
      return reset;
    },
  });
  // The theme is applied before the first frame, so that a dark page does not flash.
  look.show();
  runs.sampling.start();
  // Nothing can be drawn before the first particles, so the renderer does not share the connection with the core.
  void coreFetched().then(() => viewer.start());
  return engine;
}
