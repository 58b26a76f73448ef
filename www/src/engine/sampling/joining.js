/**
 * Joins the core's particles to a mesh in slices, and writes the mesh as a file.
 *
 * @module
 */
import { nextBudget } from '../bundle/budget.js';
import { BEAT_MS } from './protocol.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FileRequest } from '../types.js'
 * @import { Mesh, SliceEnv } from './types.js'
 */

/** First budget, in slices of up to a tenth of a millisecond. */
const FIRST_BUDGET = 32;

/**
 * Returns the result of the slices; null if they are stopped, or another job replaces the particles, before the end.
 * @template T
 * @param {(budget: number) => T | undefined} step  does this many slices; undefined before the end
 * @param {SliceEnv} env
 * @param {() => void} [tell]  called after each step; by default it shows that the worker is alive
 * @returns {Promise<T | null>}
 */
async function inSlices(step, env, tell = beats(env)) {
  const { nowMs, pause, interrupt } = env;
  let budget = FIRST_BUDGET;
  for (;;) {
    await pause();
    if (interrupt() !== null) return null;
    const before = nowMs();
    const made = step(budget);
    if (made !== undefined) return made;
    budget = nextBudget(budget, nowMs() - before);
    tell();
  }
}

/**
 * Returns a function that regularly shows the supervisor that the worker is alive.
 * @param {SliceEnv} env
 */
function beats({ nowMs, post }) {
  let beatMs = nowMs();
  return () => {
    if (nowMs() - beatMs <= BEAT_MS) return;
    post({ type: 'beat' });
    beatMs = nowMs();
  };
}

/**
 * Returns the mesh; null if it is stopped, or another job replaces the particles, before the mesh is complete.
 * @param {Pick<Core, 'join' | 'triangles'>} core
 * @param {SliceEnv} env
 * @param {() => void} [tell]  called after each step
 * @returns {Promise<Mesh | null>}
 */
export async function join(core, env, tell) {
  const about = await inSlices((budget) => core.join(budget), env, tell);
  return about && { about, triangles: core.triangles() };
}

/**
 * Returns the distance of the complete mesh from the opened one, null inside if no mesh was opened; or null if it is
 * stopped, or another job replaces the particles, before the end.
 * @param {Pick<Core, 'compare'>} core
 * @param {SliceEnv} env
 */
export const compared = (core, env) =>
  inSlices((budget) => {
    const change = core.compare(budget);
    return change === undefined ? undefined : { change };
  }, env);

/** Column name, in files, of the value that the page shows. */
const VALUE = 'value';

/**
 * Returns the values of a formula at the particles, or its error; or null if it is stopped, or another job replaces the
 * particles, before the end.
 * @param {Pick<Core, 'add_value' | 'added_value'>} core
 * @param {string} formula
 * @param {SliceEnv} env
 */
export async function valued(core, formula, env) {
  const added = await inSlices((budget) => {
    const fault = core.add_value(VALUE, formula, budget);
    return fault === undefined ? undefined : { fault };
  }, env);
  if (!added) return null;
  const { fault } = added;
  return { values: fault ? new Float32Array(0) : core.added_value(VALUE), fault: fault?.message ?? null };
}

/**
 * Returns the complete mesh as a file, null inside if it cannot be written; or null if it is stopped, or another job
 * replaces the particles, before the end.
 * @param {Pick<Core, 'mesh_file'>} core
 * @param {Partial<FileRequest>} request
 * @param {SliceEnv} env
 */
export const write = (core, request, env) =>
  inSlices((budget) => {
    const bytes = core.mesh_file(request, budget);
    return bytes === undefined ? undefined : { bytes };
  }, env);
