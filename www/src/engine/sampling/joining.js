/**
 * Joins the core's particles to a mesh in slices, and writes the mesh as a file.
 *
 * @module
 */
import { inSlices } from '../bundle/slices.js';
import { BEAT_MS } from './protocol.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FileRequest } from '../types.js'
 * @import { Mesh, AfterEnv } from './types.js'
 */

/**
 * Returns the result of the slices; null if they are stopped, or another job replaces the particles, before the end.
 * @template T
 * @param {(budget: number) => T | undefined} slice
 * @param {AfterEnv} env
 * @param {() => void} [after]  called after each slice; by default it shows that the worker is alive
 * @returns {Promise<T | null>}
 */
const made = async (slice, env, after = beats(env)) => (await inSlices(slice, env, { after })).made;

/**
 * Returns a function that regularly shows the page that the worker is alive.
 * @param {AfterEnv} env
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
 * @param {AfterEnv} env
 * @param {() => void} [after]  called after each slice
 * @returns {Promise<Mesh | null>}
 */
export async function join(core, env, after) {
  const about = await made((budget) => core.join(budget), env, after);
  return about && { about, triangles: core.triangles() };
}

/**
 * Returns the distance of the complete mesh from the opened one, null inside if no mesh was opened; or null if it is
 * stopped, or another job replaces the particles, before the end.
 * @param {Pick<Core, 'compare'>} core
 * @param {AfterEnv} env
 */
export const compared = (core, env) =>
  made((budget) => {
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
 * @param {AfterEnv} env
 */
export async function valued(core, formula, env) {
  const added = await made((budget) => {
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
 * @param {AfterEnv} env
 */
export const write = (core, request, env) =>
  made((budget) => {
    const bytes = core.mesh_file(request, budget);
    return bytes === undefined ? undefined : { bytes };
  }, env);
