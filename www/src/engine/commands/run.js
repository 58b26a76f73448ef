/**
 * Commands that start and stop the sampler.
 *
 * @module
 */
import { completeSettings } from '../share/state.js';
import { change, changeView, description, showAll } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { EngineCommands } from '../types.js'
 */

/** Largest number of relaxation steps of one command. */
const MOST_STEPS = 1000;

/** @typedef {Pick<EngineCommands, 'run' | 'stop' | 'generateOnly' | 'relax' | 'makeMesh'>} RunCommands */

/** @param {Parts} parts @returns {RunCommands} */
export function runCommands({ store, columns, runs }) {
  return {
    run() {
      showAll(store);
      runs.resample({ grow: true });
    },
    makeMesh() {
      const { settings } = store.state.value;
      const isRefined = settings.method === 'refined' && columns.record?.settings.method === 'refined';
      change(store, { settings: { ...settings, method: 'refined' } });
      // Before the picture asks for a mesh, so that the present particles are not joined to one.
      if (!isRefined || store.partial.value) runs.resample();
      changeView(store, { draw: 'mesh', level: null, step: null });
    },
    stop: () => runs.stop(),
    generateOnly() {
      const settings = { ...completeSettings(description(store), store.state.value.settings), relax_steps: 0 };
      runs.resample({ grow: true, settings });
    },
    relax(steps) {
      if (steps > 0) runs.sampling.relax(Math.min(MOST_STEPS, Math.round(steps)));
    },
  };
}
