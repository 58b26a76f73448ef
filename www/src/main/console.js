/**
 * Makes `window.marchingParticles`, which drives the page from the console or from a test. See docs/page.md.
 *
 * @module
 */
import { MEASURED } from '../engine/columns.js';
import { createEngine } from '../engine/index.js';
import { atRest, once, settled } from '../engine/rest.js';

/**
 * @import { Columns, Engine } from '../engine/types.js'
 * @import { Console, Measured, Particles } from './types.js'
 */

/** Copies of the columns that the report measures. @param {Columns} columns */
const measuredOf = (columns) =>
  /** @type {Measured} */ (Object.fromEntries(MEASURED.map((name) => [name, columns[name]?.slice() ?? null])));

/** @param {Columns} columns @returns {Particles} */
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
    ...measuredOf(columns),
    curvature: count > 0 && columns.curved === count ? columns.curvature.slice(0, 2 * count) : null,
  };
}

/** @param {Engine} engine */
const statusOf = (engine) => ({
  backend: engine.backend.value,
  adapter: engine.adapter.value,
  busy: engine.status.value === 'sampling',
  progress: { ...engine.progress.value },
  partial: engine.result.value === 'partial',
  empty: engine.result.value === 'none',
  dimmed: engine.debug.counts().dimmed,
  fieldError: engine.fieldError.value,
  loading: engine.loading.value,
  loadingError: engine.loadingError.value,
  model: engine.model.value,
  timing: engine.timing.value,
  lastDrag: engine.lastDrag.value,
  mesh: engine.mesh.value,
  notice: engine.notice.value && { ...engine.notice.value, action: engine.notice.value.action?.label },
});

/** @param {Engine} engine @returns {Console} */
export function createConsole(engine) {
  /** @param {() => void} act */
  const after = (act) => {
    act();
    return settled(engine);
  };
  /**
   * Like `after`, for actions that sample the formula: an error in it must not return the previous surface's report.
   * @param {() => void} act
   */
  const sampled = async (act) => {
    const report = await after(act);
    const fault = engine.fieldError.peek();
    if (fault) throw new Error(fault.message);
    return report;
  };
  const { debug } = engine;
  return {
    get version() {
      return engine.description.value?.version ?? '';
    },
    ready: settled(engine),
    get state() {
      return structuredClone(engine.state.value);
    },
    set: (patch) =>
      sampled(() => {
        const reset = engine.set({ ...patch });
        if (reset.length) console.warn(`Reset: ${reset.join(', ')}`);
      }),
    run: () => sampled(() => engine.run()),
    stop() {
      engine.stop();
      return once(engine, () => atRest(engine));
    },
    open: (file) => after(() => void engine.openFile(file)),
    relax: (steps = 1) => after(() => engine.relax(steps)),
    link: async () => location.origin + location.pathname + (await engine.link()),
    report: () => structuredClone(engine.report.value),
    particles: () => copyOf(engine.columns),
    status: () => statusOf(engine),
    async pixels(width, height, transparent = false) {
      const picture = await engine.picture({ width, height, transparent });
      return { width: picture.width, height: picture.height, pixels: new Uint8Array(picture.data.buffer) };
    },
    create: (options) => createEngine(options),
    engine,
    debug: {
      loseDevice: debug.loseDevice,
      stale: debug.stale,
      still: debug.still,
      counts: debug.counts,
    },
  };
}
