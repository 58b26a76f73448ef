/**
 * The kinds of runs, and what each means for the picture, for the user and for the worker.
 *
 * @module
 */

/** @import { RunKind } from '../types.js' */

/**
 * `grows`: the particles are sent while the front grows; otherwise the present picture stays until the front is
 * complete. `fits`: the camera fits the surface. `isLive`: a run of a drag, whose columns are sent once, at its end. It
 * has no report unless it is stopped. `isUnasked`: nobody is asked about a large number of particles. `restores`: the
 * run is of the surface on the page or of the one before it, while the state names another.
 * @typedef {Partial<Record<'grows' | 'fits' | 'isLive' | 'isUnasked' | 'restores', boolean>>} Traits
 */

/** @type {Readonly<Record<RunKind, Traits>>} */
export const KINDS = {
  // A new surface: it is seen to grow, and the camera fits it.
  new: { grows: true, fits: true },
  // The same under the camera as it is.
  grow: { grows: true },
  // The same after the user has agreed to a large number of particles.
  agreed: { grows: true, isUnasked: true },
  // It takes the place of the picture.
  change: {},
  // The same after a control has changed the surface, so that the particles may follow it.
  move: {},
  // The same while the control rests and is still held: the next change waits for its particles.
  rest: {},
  // Of a formula that is still being typed. The surface before it can come back.
  trial: {},
  // During a drag.
  live: { isLive: true, isUnasked: true },
  // The same with fewer particles than the state asks for, or of the coarse level of a refinement alone.
  sketch: { isLive: true, isUnasked: true },
  // What is on the page, once more, with as many particles as there were.
  again: { isUnasked: true },
  // Completes the surface on the page, or brings back the one before a trial.
  restore: { isUnasked: true, restores: true },
  // Brings back the one before a trial that has no surface, to be seen and no more.
  backdrop: { isLive: true, isUnasked: true, restores: true },
  // Relaxation steps on the particles that the worker holds.
  relax: { grows: true },
};
