/**
 * The engine of the page: samples in a worker, draws on a canvas, keeps the state. The interface reads its signals and calls
 * its commands; it needs nothing else of this folder but the types.
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
import { mergeState, surfaceOf } from './share/state.js';
import { createStore, description } from './store.js';
import { BACKENDS } from './view/backends.js';

/**
 * What the engine is made of, and its commands act on.
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
 * @param {{canvasHost: HTMLElement}} options  `canvasHost`, which is positioned, is filled with a canvas of its own size
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
      void address.load(location.hash, true);
      fetchExports().catch(() => {});
    },
  });
  const address = new Address({ store, hasFile: () => runs.loader.hasFile, apply: applyState });
  const look = new Look({ store, viewer, runs });
  const framing = new Framing({ store, columns, viewer, look });

  /** Takes a whole state for the page's own, and samples it. @param {import('./types.js').State} state  a valid one */
  function applyState(state) {
    store.state.value = state;
    const bounds = state.bounds ?? surfaceOf(store.description.value, state.surface)?.bounds;
    if (bounds) viewer.setBounds(bounds);
    const { camera } = state.view;
    viewer.camera.set(camera);
    if (camera.fit && runs.loader.ready()) viewer.fit(true);
    look.show();
    // Where the link's surface cannot be had, the camera comes back to the one that stays.
    framing.written();
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
  // A dark page is dark from the start.
  look.show();
  runs.sampling.start();
  void viewer.start();
  return engine;
}
