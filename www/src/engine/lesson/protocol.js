/**
 * Messages between the page and the worker of the lesson. The worker follows one run at a time; every question is
 * answered under its number.
 *
 * @module
 */

/** @import { Bounds, LessonEvent, LessonField, LessonIterate, LessonLife, LessonPush } from '../core-types.js' */

/**
 * @typedef {import('../core-types.js').LessonSettings} LessonSettings
 * @typedef {import('../core-types.js').LessonProgress} LessonProgress
 * @typedef {import('../core-types.js').LessonChapter} LessonChapter
 * @typedef {import('../core-types.js').Fault} Fault
 */
/** @typedef {[number, number, number]} Vec3 */
/**
 * What to sample: a formula, or the solved system of a model from points.
 * @typedef {LessonField | {system: Uint8Array, bounds: Bounds}} Surface
 */

/**
 * The particles at the moment that was sought. Vectors have three floats each; `parents` has 0xffffffff for a seed,
 * `done` 1 for a particle whose children are placed.
 * @typedef {object} Particles
 * @property {number} at  number of events that have happened
 * @property {Float32Array} positions
 * @property {Float32Array} normals
 * @property {Float32Array} radii
 * @property {Uint32Array} levels
 * @property {Uint32Array} parents
 * @property {Uint32Array} fronts
 * @property {Uint32Array} slots
 * @property {Uint8Array} done
 */

/**
 * How far a run has come, and the milliseconds that its worker has worked for it since it was asked.
 * @typedef {{progress: LessonProgress, workMs: number}} Advanced
 */

/**
 * A plane through a point: `right` and `up` are perpendicular unit vectors.
 * @typedef {{centre: Vec3, right: Vec3, up: Vec3, half: number, cells: number}} Plane
 */

/**
 * What may be asked of a run, and the answers. `events` and `chapters` are what there is so far.
 * @typedef {object} Questions
 * @property {{ask: {first: number}, answer: LessonChapter[]}} chapters  from number `first` on
 * @property {{ask: {first: number, count: number}, answer: LessonEvent[]}} events
 * @property {{ask: {event: number}, answer: Particles}} seek  the particles before that event; at the end for a larger
 *   number
 * @property {{ask: {particle: number}, answer: LessonLife | null}} life
 * @property {{ask: {particle: number}, answer: LessonPush[]}} pushes  of a relaxation on a particle, at the moment that
 *   was sought
 * @property {{ask: Plane, answer: Float32Array}} section  the curve f = 0 in the plane: segments as x₀, y₀, x₁, y₁
 *   around the centre
 * @property {{ask: {start: Vec3, reach: number}, answer: LessonIterate[]}} newton  Newton's method in space from a
 *   point
 * @property {{ask: {units: number}, answer: Advanced}} advance  goes on with a run that was begun and held
 * @property {{ask: {}, answer: string}} digest  of the particles at the moment that was sought
 */

/**
 * `holds`: the run only begins, and goes on by `advance`.
 * @typedef {{type: 'start', id: number, surface: Surface, settings: Partial<LessonSettings>, holds: boolean}
 *   | {type: 'stop'}
 *   | {[K in keyof Questions]: {type: 'ask', id: number, about: K, ask: Questions[K]['ask']}}[keyof Questions]}
 *   ToLesson
 */
/**
 * `ended`: the run came to its end, or was stopped or held; `refused`: it could not begin; `failed`: the bundle did not
 * load.
 * @typedef {{type: 'progress', id: number, progress: LessonProgress}
 *   | {type: 'ended', id: number, progress: LessonProgress}
 *   | {type: 'refused', id: number, error: Fault}
 *   | {type: 'answer', id: number, answer: unknown}
 *   | {type: 'crashed', message: string, stack: string}
 *   | {type: 'failed', message: string}} FromLesson
 */

export {};
