/**
 * Installs `window.marchingParticles`, which drives the page from the console or from a test. See www/CONSOLE.md.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** Delay between a motion of the camera and its entry in the state. */
export const CAMERA_MS = 120;

/**
 * @typedef {import('./types.js').Engine} Engine
 * @typedef {import('./types.js').Report} Report
 * @typedef {import('./types.js').State} State
 */
/**
 * @typedef {object} Console
 * @property {string} version  of the core; empty until the core has loaded
 * @property {Promise<Report | null>} ready  resolves once the first run is done and on screen
 * @property {State} state
 * @property {(patch: object) => Promise<Report | null>} set  changes the state, samples, and resolves with the report
 * @property {() => Promise<Report | null>} run
 * @property {() => Promise<Report | null>} stop
 * @property {(file: File) => Promise<Report | null>} open  samples the points of a file
 * @property {(steps?: number) => Promise<Report | null>} relax
 * @property {() => Report | null} report
 * @property {() => Particles} particles
 * @property {() => object} status
 * @property {(width: number, height: number, transparent?: boolean) => Promise<{width: number, height: number, pixels: Uint8Array}>} pixels
 * @property {Engine} engine
 * @property {Debug} debug
 */
/**
 * Copies of the columns: index i of each belongs to particle i.
 * @typedef {object} Particles
 * @property {number} count
 * @property {Float32Array} positions
 * @property {Float64Array | null} exact  the positions in double precision, in a box far from the origin
 * @property {Float32Array} normals
 * @property {Float32Array} radii
 * @property {Uint32Array} levels
 * @property {Uint32Array} parents
 * @property {Uint32Array} slots
 * @property {Uint8Array | null} valence
 * @property {Float32Array | null} nearest
 * @property {Float32Array | null} residual
 * @property {Uint32Array | null} component
 * @property {Float32Array | null} curvature  two per particle, only while they are shown
 */
/**
 * Faults that the tests provoke, and what they wait for.
 * @typedef {object} Debug
 * @property {() => void} panic  traps the core in its worker
 * @property {() => void} overflow  overflows the worker's stack
 * @property {() => void} hang  sends the worker into an endless loop
 * @property {(reason?: string) => void} loseDevice
 * @property {(id: number) => void} stale  delivers a message of another run to the page
 * @property {() => Promise<void>} still  resolves once the picture stands still and the state has the camera
 * @property {() => {frames: number, uploads: number, opened: number, restarts: number, stale: number}} counts
 */

/**
 * Resolves once the picture stands still and the camera is written to the state, which it is a little later.
 * @param {import('./view/viewer.js').Viewer} viewer @returns {Promise<void>}
 */
const still = (viewer) =>
  new Promise((resolve) => {
    const look = () => {
      if ((viewer.frames.asked !== 0 || viewer.reveal.active) && !document.hidden) requestAnimationFrame(look);
      else setTimeout(resolve, CAMERA_MS + 10);
    };
    // The check is deferred, because a signal can change during a frame, before that frame requests the next one.
    setTimeout(look);
  });

/**
 * Resolves with the report once `isOver` holds, or no sampler is there or coming. `isOver` reads signals.
 * @param {Pick<Parts, 'engine' | 'sampling'>} parts @param {() => boolean} isOver
 */
const once = ({ engine, sampling }, isOver) =>
  new Promise((/** @type {(report: Report | null) => void} */ resolve) => {
    /** @type {() => void} */
    let stop = () => {};
    stop = effect(() => {
      // The progress is written anew when the sampler ends. The notice about it may have been dismissed since.
      const isOff = engine.progress.value && ['failed', 'safe'].includes(sampling.supervisor.state);
      if (!isOff && !isOver()) return;
      resolve(engine.report.peek());
      queueMicrotask(() => stop());
    });
  });

/** Returns whether no run is active and the report has arrived, if one is expected. @param {Engine} engine */
const atRest = (engine) =>
  engine.description.value !== null &&
  engine.loading.value === null &&
  !engine.busy.value &&
  engine.progress.value.phase === 'done';

/** Resolves with the report once the sampler is at rest and the picture is up to date. @param {Parts} parts */
async function settled(parts) {
  const { engine } = parts;
  const drawable = () => engine.reveal.value === null && engine.backend.value !== 'starting';
  const report = await once(parts, () => atRest(engine) && drawable());
  await still(parts.viewer);
  return report;
}

/** @param {import('./columns.js').Columns} columns @returns {Particles} */
function copyOf(columns) {
  const count = columns.stale ? 0 : columns.count;
  return {
    count,
    positions: columns.positions.slice(0, 3 * count),
    exact: columns.exact.length > 0 ? columns.exact.slice(0, 3 * count) : null,
    normals: columns.normals.slice(0, 3 * count),
    radii: columns.radii.slice(0, count),
    levels: columns.levels.slice(0, count),
    parents: columns.parents.slice(0, count),
    slots: columns.slots.slice(0, count),
    valence: columns.valence?.slice() ?? null,
    nearest: columns.nearest?.slice() ?? null,
    residual: columns.residual?.slice() ?? null,
    component: columns.component?.slice() ?? null,
    curvature: count > 0 && columns.curved === count ? columns.curvature.slice(0, 2 * count) : null,
  };
}

/** @param {Engine} engine @param {import('./view/viewer.js').Viewer} viewer */
const statusOf = (engine, viewer) => ({
  backend: engine.backend.value,
  adapter: engine.adapter.value,
  busy: engine.busy.value,
  progress: { ...engine.progress.value },
  partial: engine.partial.value,
  empty: engine.empty.value,
  dimmed: viewer.dimmer.on,
  fieldError: engine.fieldError.value,
  loading: engine.loading.value,
  loadingError: engine.loadingError.value,
  model: engine.model.value,
  timing: engine.timing.value,
  lastDrag: engine.lastDrag.value,
  mesh: engine.mesh.value,
  notice: engine.notice.value && { ...engine.notice.value, action: engine.notice.value.action?.label },
});

/** @param {Parts} parts @returns {Debug} */
function debugOf({ engine, viewer, sampling }) {
  const provoke = (/** @type {'panic' | 'overflow' | 'hang'} */ fault) =>
    sampling.supervisor.post({ type: 'provoke', fault });
  return {
    panic: () => provoke('panic'),
    overflow: () => provoke('overflow'),
    hang: () => provoke('hang'),
    loseDevice(reason = 'unknown') {
      const { device } = viewer.keeper;
      if (reason === 'unknown') viewer.keeper.lost('unknown: asked for from the console');
      else device?.renderer.destroy();
    },
    stale(id) {
      sampling.receive({
        type: 'progress',
        id,
        progress: { ...engine.progress.value, phase: 'generation', particles: 123_456_789 },
      });
    },
    still: () => still(viewer),
    counts: () => ({
      frames: viewer.frames.drawn,
      uploads: viewer.upload.writes,
      opened: viewer.keeper.opened,
      restarts: sampling.supervisor.restarts.length,
      stale: sampling.stale,
    }),
  };
}

/**
 * The parts of the engine that the console uses.
 * @typedef {object} Parts
 * @property {Engine} engine
 * @property {import('./view/viewer.js').Viewer} viewer
 * @property {import('./sampling/client.js').SamplingClient} sampling
 * @property {import('./columns.js').Columns} columns
 * @property {(patch: Record<string, unknown>) => string[]} applyState
 */

/** @param {Parts} parts */
export function installConsole(parts) {
  const { engine, viewer, columns, applyState } = parts;
  /** @param {() => void} act */
  const after = (act) => {
    act();
    return settled(parts);
  };
  /** @type {Console} */
  const face = {
    get version() {
      return engine.description.value?.version ?? '';
    },
    ready: settled(parts),
    get state() {
      return structuredClone(engine.state.value);
    },
    set: (patch) =>
      after(() => {
        const reset = applyState({ ...patch });
        if (reset.length) console.warn(`Reset: ${reset.join(', ')}`);
      }),
    run: () => after(() => engine.run()),
    stop() {
      engine.stop();
      return once(parts, () => atRest(engine));
    },
    open: (file) => after(() => void engine.openFile(file)),
    relax: (steps = 1) => after(() => engine.relax(steps)),
    report: () => structuredClone(engine.report.value),
    particles: () => copyOf(columns),
    status: () => statusOf(engine, viewer),
    pixels: (width, height, transparent = false) => viewer.pixels(width, height, transparent),
    engine,
    debug: debugOf(parts),
  };
  /** @type {any} */ (window).marchingParticles = face;
}
