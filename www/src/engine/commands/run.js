/**
 * Commands that start and stop the sampler.
 *
 * @module
 */
import { patternOf, unrelaxed } from '../patterns.js';
import { completeSettings } from '../share/state.js';
import { changeView, description, showAll } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { EngineCommands, Settings } from '../types.js'
 */

/** Largest number of relaxation steps of one command. */
const MOST_STEPS = 1000;

/**
 * @typedef {Pick<EngineCommands, 'run' | 'stop' | 'generateOnly' | 'relax' | 'makeMesh' | 'leaveMesh' |
 *   'leaveOutChips'>} RunCommands
 */

/** @param {Parts} parts @returns {RunCommands} */
export function runCommands({ store, columns, sampler, picture: { viewer } }) {
  /** Whether a method placed the particles. @param {Settings[string]} method */
  const isOf = (method) => columns.record?.settings.method === method;
  return {
    run() {
      showAll(store);
      sampler.resample({ kind: 'grow' });
    },
    makeMesh() {
      const { draw, level, step } = store.state.value.view;
      store.meshing.value ??= { draw, level, step };
      // This comes before the picture asks for a mesh, so that no mesh is made of the current particles.
      if (!isOf('refined') || store.result.value === 'partial') sampler.resample();
      changeView(store, { draw: 'mesh', level: null, step: null });
    },
    leaveMesh() {
      const before = store.meshing.value;
      if (!before) return;
      store.meshing.value = null;
      const { view, settings } = store.state.value;
      // If the user chose another way of drawing meanwhile, it stays.
      if (view.draw === 'mesh') changeView(store, before);
      if (!isOf(completeSettings(description(store), settings).method)) sampler.resample();
    },
    leaveOutChips() {
      if (!columns.mesh?.about.chips.length) return;
      columns.leaveOutChips();
      viewer.meshed();
      store.mesh.value = columns.mesh.about;
    },
    stop() {
      sampler.stop();
      viewer.complete();
    },
    generateOnly() {
      if (unrelaxed(patternOf(store.state.value.settings))) return;
      const settings = { ...completeSettings(description(store), store.state.value.settings), relax_steps: 0 };
      sampler.resample({ kind: 'grow', settings });
    },
    relax(steps) {
      if (steps > 0 && !unrelaxed(columns.pattern)) sampler.relax(Math.min(MOST_STEPS, Math.round(steps)));
    },
  };
}
