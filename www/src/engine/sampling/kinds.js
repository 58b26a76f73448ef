/**
 * The kinds of jobs, and what each means for the picture, the user and the worker.
 *
 * @module
 */

/** @import { JobKind } from '../types.js' */

/**
 * `grows`: the particles are sent while the front grows; otherwise the current picture stays until the front is
 * complete. `fits`: the camera fits the surface. `isLive`: a run during a drag. Its columns are sent once, at the end,
 * and it has a report only if it is stopped. `isUnasked`: the user is not asked about a large number of particles.
 * `restores`: the run is for the surface on the page or the one before it, while the state names another.
 * @typedef {Partial<Record<'grows' | 'fits' | 'isLive' | 'isUnasked' | 'restores', boolean>>} Traits
 */

/** @type {Readonly<Record<JobKind, Traits>>} */
export const KINDS = {
  // A new surface, shown while it grows; the camera fits it.
  new: { grows: true, fits: true },
  // The same, but the camera stays.
  grow: { grows: true },
  // The same after the user has agreed to a large number of particles.
  agreed: { grows: true, isUnasked: true },
  // It replaces the picture.
  change: {},
  // The same after a control has changed the surface; the particles may follow it.
  move: {},
  // The same while the control rests but is still held; the next change waits for the particles.
  rest: {},
  // A formula that is still being typed. The previous surface can come back.
  trial: {},
  // During a drag.
  live: { isLive: true, isUnasked: true },
  // The same with fewer particles than requested, or only the coarse level of a refinement.
  sketch: { isLive: true, isUnasked: true },
  // The surface on the page again, with the same number of particles.
  again: { isUnasked: true },
  // Completes the surface on the page, or restores the one before a trial.
  restore: { isUnasked: true, restores: true },
  // Restores the surface before a trial that has no surface, only to be seen.
  backdrop: { isLive: true, isUnasked: true, restores: true },
  // Relaxation steps for the worker's particles.
  relax: { grows: true },
};
