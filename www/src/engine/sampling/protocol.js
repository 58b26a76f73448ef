/**
 * Messages between the page and the sampler's worker.
 *
 * Every message about a job carries the job's id, and the page drops messages of older jobs. Columns are sent as
 * transferred buffers. The page acknowledges them after the next frame, and the worker sends more only after that, so
 * that messages do not pile up before a slow graphics device.
 *
 * @module
 */

/**
 * @import { Figures } from '../columns.js'
 * @import { Solved } from '../points/protocol.js'
 * @import { CoreProgress, Description, FieldAnswer, FieldOk, FieldRequest, MeshFormat, Report } from '../types.js'
 * @import { Seconds, Settings } from '../types.js'
 */

/**
 * @typedef {import('../types.js').Mesh} Mesh
 */

/**
 * Samples the field from the start. With `grow` the columns are sent while the front grows; otherwise they are sent
 * once the front is complete, so that the present picture stays until then. A `live` job comes from a drag: its columns
 * are sent once, at the end, and it has no report unless it is stopped. With `coarse` it ends where a refinement has
 * finished its coarse level: the particles that the full run refines. A job with more than `askAbove` expected
 * particles is returned without running. `points` is the solved model that `field` names.
 * @typedef {object} SampleJob
 * @property {'sample'} kind
 * @property {number} id
 * @property {FieldRequest} field
 * @property {Pick<Solved, 'field' | 'info'> | null} points
 * @property {Settings} settings
 * @property {boolean} grow
 * @property {boolean} live
 * @property {boolean} coarse
 * @property {number} askAbove
 */
/**
 * Relaxes the particles that the worker holds. They must be those of job `of`.
 * @typedef {{kind: 'relax', id: number, of: number, steps: number, live: false, grow: true}} RelaxJob
 */
/** @typedef {SampleJob | RelaxJob} Job */

/**
 * A `job` replaces the running one once the core has accepted its field. If the field is refused, the running job
 * continues. `stop` ends every job sent before it. `curvature` says whether the page shows the curvature. If so, it is
 * sent with the other columns, and at once for the particles that the worker holds. `mesh` says whether the page draws
 * a mesh. If so, it is made at the end of every run, and sent with the last columns. `export` asks for the mesh as a
 * file, once no job is left. The first message is `core`, or `no_core` if the core could not be loaded.
 * @typedef {{type: 'core', module: WebAssembly.Module}
 *   | {type: 'no_core', fault: LoadFault, message: string}
 *   | {type: 'job', job: Job}
 *   | {type: 'curvature', on: boolean}
 *   | {type: 'mesh', on: boolean}
 *   | {type: 'export', request: number, format: MeshFormat}
 *   | {type: 'stop'}
 *   | {type: 'drawn', id: number}
 *   | {type: 'provoke', fault: Fault}} ToWorker
 */
/** Faults that tests provoke. @typedef {'panic' | 'hang' | 'overflow'} Fault */

/**
 * How a job ended. `refused`: the core rejected the settings; `ask`: more particles than `askAbove` are expected;
 * `lost`: the worker no longer holds the particles to relax. A job whose field was refused ends with that answer. A job
 * that is replaced ends without a message.
 * @typedef {'complete' | 'stopped' | 'refused' | 'ask' | 'lost'} Outcome
 */
/**
 * @typedef {object} ColumnsMessage
 * @property {'columns'} type
 * @property {number} id
 * @property {number} first
 * @property {number} total
 * @property {Float32Array} positions
 * @property {Float64Array} [exact]  the positions in double precision, in a box far from the origin; else empty
 * @property {Float32Array} normals
 * @property {Float32Array} radii
 * @property {Uint32Array} levels
 * @property {Uint32Array} parents
 * @property {number} slotsFrom
 * @property {Uint32Array} slots
 * @property {number} curvatureFrom
 * @property {Float32Array} curvature  empty unless the page shows it
 * @property {Mesh | null} mesh  null unless the page draws it and the run is over
 * @property {CoreProgress | null} progress  null for columns sent after the run
 */
/**
 * The positions before each relaxation step of the run, or before the first alone where there are many particles.
 * @typedef {{type: 'past', id: number, positions: Float32Array[]}} PastMessage
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
/** @typedef {{type: 'report', id: number, report: Report} & Figures} ReportMessage */
/** @typedef {import('../bundle/load.js').LoadFault} LoadFault */
/**
 * @typedef {{type: 'ready', description: Description}
 *   | {type: 'failed', fault: LoadFault, message: string}
 *   | {type: 'beat'}
 *   | {type: 'field', id: number, answer: FieldAnswer}
 *   | {type: 'box', id: number, answer: FieldOk}
 *   | {type: 'started', id: number, radius: number, predicted: number, warnings: string[]}
 *   | {type: 'progress', id: number, progress: CoreProgress}
 *   | ColumnsMessage | PastMessage | DoneMessage | ReportMessage
 *   | {type: 'file', request: number, bytes: Uint8Array<ArrayBuffer> | null}
 *   | {type: 'crashed', id: number, message: string, stack: string}} FromWorker
 */

/** Interval between progress messages of a job that sends no columns. */
export const PROGRESS_MS = 60;
/** Largest number of particles of which the positions are kept at every relaxation step: 2.4 MB in ten steps. */
export const MOST_REMEMBERED = 20_000;
/** Largest interval between messages while the worker loads or measures. */
export const BEAT_MS = 250;
/** Time without a message after which a busy worker counts as hung. */
export const SILENCE_MS = 2000;
