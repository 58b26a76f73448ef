/**
 * What the page and the sampler's worker say to each other.
 *
 * Every message about a job carries the job's id; the page drops what belongs to an older one. Columns travel as transferred
 * buffers. A picture's worth of columns is acknowledged once it has been drawn, and the worker sends the next only then, so
 * that a slow graphics device is never flooded.
 *
 * @module
 */

/**
 * @typedef {import('../types.js').FieldRequest} FieldRequest
 * @typedef {import('../types.js').FieldAnswer} FieldAnswer
 * @typedef {import('../types.js').Settings} Settings
 * @typedef {import('../types.js').CoreProgress} CoreProgress
 * @typedef {import('../types.js').Report} Report
 * @typedef {import('../types.js').Seconds} Seconds
 * @typedef {import('../types.js').Description} Description
 */

/**
 * Sample the field from the start. `grow` shows the surface while it grows; otherwise columns come once the front is
 * complete, so that a picture already there stays until its successor is whole. A `live` job comes from a control that is
 * being dragged: columns once, at the end, and no report unless it is stopped. `askAbove` is the number of particles beyond which the job is
 * handed back unstarted. `points` is the solved model that `field` names.
 * @typedef {object} SampleJob
 * @property {'sample'} kind
 * @property {number} id
 * @property {FieldRequest} field
 * @property {Pick<import('../points/protocol.js').Solved, 'field' | 'info'> | null} points
 * @property {Settings} settings
 * @property {boolean} grow
 * @property {boolean} live
 * @property {number} askAbove
 */
/**
 * Relax the particles that the worker holds, which must be those of job `of`.
 * @typedef {{kind: 'relax', id: number, of: number, steps: number, live: false, grow: true}} RelaxJob
 */
/** @typedef {SampleJob | RelaxJob} Job */

/**
 * A `job` takes over from the one before once the core has accepted its field; until then, and for good where the field is
 * refused, that one goes on. `stop` ends every job sent before it. `curvature` says whether the page shows the curvature: it then comes with the other columns, and at once for the particles
 * that are held. `core` comes first, or `no_core` where it could not be loaded.
 * @typedef {{type: 'core', module: WebAssembly.Module}
 *   | {type: 'no_core', fault: LoadFault, message: string}
 *   | {type: 'job', job: Job}
 *   | {type: 'curvature', on: boolean}
 *   | {type: 'stop'}
 *   | {type: 'drawn', id: number}
 *   | {type: 'provoke', fault: Fault}} ToWorker
 */
/** Faults that tests provoke. @typedef {'panic' | 'hang' | 'overflow'} Fault */

/**
 * How a job ended. `refused`: the settings were not accepted; `ask`: more particles than `askAbove` are expected;
 * `lost`: the particles to relax are no longer there. A job whose field was refused has ended with that answer, and one that
 * a newer one takes over from ends without a word.
 * @typedef {'complete' | 'stopped' | 'refused' | 'ask' | 'lost'} Outcome
 */
/**
 * @typedef {object} ColumnsMessage
 * @property {'columns'} type
 * @property {number} id
 * @property {number} first
 * @property {number} total
 * @property {Float32Array} positions
 * @property {Float32Array} normals
 * @property {Float32Array} radii
 * @property {Uint32Array} levels
 * @property {Uint32Array} parents
 * @property {number} slotsFrom
 * @property {Uint32Array} slots
 * @property {number} curvatureFrom
 * @property {Float32Array} curvature  empty unless the page shows it
 * @property {CoreProgress | null} progress  null for columns sent after the run
 */
/**
 * @typedef {object} DoneMessage
 * @property {'done'} type
 * @property {number} id
 * @property {Outcome} outcome
 * @property {CoreProgress | null} progress
 * @property {Seconds} seconds
 * @property {number} predicted  particles expected at the start, 0 when unknown
 * @property {string} message  words for `refused`, else empty
 * @property {boolean} reportFollows
 */
/**
 * @typedef {object} ReportMessage
 * @property {'report'} type
 * @property {number} id
 * @property {Report} report
 * @property {Uint8Array} valence
 * @property {Float32Array} nearest
 * @property {Float32Array} residual
 * @property {Uint32Array} component
 */
/** @typedef {import('../bundle/load.js').LoadFault} LoadFault */
/**
 * @typedef {{type: 'ready', description: Description}
 *   | {type: 'failed', fault: LoadFault, message: string}
 *   | {type: 'beat'}
 *   | {type: 'field', id: number, answer: FieldAnswer}
 *   | {type: 'started', id: number, radius: number, predicted: number, warnings: string[]}
 *   | {type: 'progress', id: number, progress: CoreProgress}
 *   | ColumnsMessage | DoneMessage | ReportMessage
 *   | {type: 'crashed', id: number, message: string, stack: string}} FromWorker
 */

/** A job without columns to show tells how far it is at this pace. */
export const PROGRESS_MS = 60;
/** The worker speaks at least this often while it loads or measures. */
export const BEAT_MS = 250;
/** Silence after which a busy worker counts as hung. */
export const SILENCE_MS = 2000;
