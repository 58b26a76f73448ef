/**
 * Joins the particles that the core holds to a mesh, slice by slice, and writes the mesh as a file.
 *
 * @module
 */
import { nextBudget } from '../bundle/budget.js';
import { BEAT_MS } from './protocol.js';

/** First budget, in slices of up to a tenth of a millisecond. */
const FIRST_SLICES = 32;

/**
 * @typedef {import('./job.js').CoreLike} CoreLike
 * @typedef {Pick<import('./job.js').Surroundings, 'nowMs' | 'pause' | 'post' | 'interrupt'>} Surroundings
 */

/**
 * Returns the mesh, or null if another job replaces the particles before it is complete.
 * @param {Pick<CoreLike, 'join' | 'triangles'>} core
 * @param {Surroundings} env
 * @returns {Promise<import('./protocol.js').Mesh | null>}
 */
export async function join(core, { nowMs, pause, post, interrupt }) {
  let slices = FIRST_SLICES;
  let beatMs = nowMs();
  for (;;) {
    await pause();
    if (interrupt() === 'replace') return null;
    const before = nowMs();
    const about = core.join(slices);
    if (about) return { about, triangles: core.triangles() };
    slices = nextBudget(slices, nowMs() - before);
    if (nowMs() - beatMs > BEAT_MS) {
      post({ type: 'beat' });
      beatMs = nowMs();
    }
  }
}
