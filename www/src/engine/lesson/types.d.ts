// Messages between the page and the worker of the lesson, and what its clients are given. The worker follows one run at
// a time; every question is answered under its number.
import type { Bounds, LessonEvent, LessonField, LessonIterate, LessonLife, Pull } from '../core-types.js';

export type WorkerLike = import('../bundle/types.js').WorkerLike<ToLesson, FromLesson>;
export type LessonSettings = import('../core-types.js').LessonSettings;
export type LessonProgress = import('../core-types.js').LessonProgress;
export type LessonChapter = import('../core-types.js').LessonChapter;
export type Fault = import('../core-types.js').Fault;
export type Vec3 = [number, number, number];
/** The surface to sample: a formula, or the solved system of a model from points. */
export type Surface = LessonField | { system: Uint8Array; pulls: readonly Pull[]; bounds: Bounds };
/**
 * The particles at the moment that was sought. Vectors have three floats each; `parents` has 0xffffffff for a seed,
 * `done` 1 for a particle whose children are placed.
 */
export interface Particles {
  /** number of events that have happened */
  at: number;
  positions: Float32Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
  parents: Uint32Array;
  fronts: Uint32Array;
  slots: Uint32Array;
  done: Uint8Array;
}
/** A plane through a point: `right` and `up` are perpendicular unit vectors. */
export type Plane = { centre: Vec3; right: Vec3; up: Vec3; half: number; cells: number };
/** The questions about a run and their answers. `events` and `chapters` are what there is so far. */
export interface Questions {
  /** from number `first` on */
  chapters: { ask: { first: number }; answer: LessonChapter[] };
  events: { ask: { first: number; count: number }; answer: LessonEvent[] };
  /** the particles before that event; at the end for a larger number */
  seek: { ask: { event: number }; answer: Particles };
  life: { ask: { particle: number }; answer: LessonLife | null };
  /** the curve f = 0 in the plane: segments as x₀, y₀, x₁, y₁ around the centre */
  section: { ask: Plane; answer: Float32Array };
  /** Newton's method in space from a point */
  newton: { ask: { start: Vec3; reach: number }; answer: LessonIterate[] };
}
export type ToLesson =
  | { type: 'start'; id: number; surface: Surface; settings: Partial<LessonSettings> }
  | { type: 'stop' }
  | { [K in keyof Questions]: { type: 'ask'; id: number; about: K; ask: Questions[K]['ask'] } }[keyof Questions];
/**
 * `ended`: the run came to its end, or was stopped or held; `refused`: it could not begin; `failed`: the bundle did not
 * load.
 */
export type FromLesson =
  | { type: 'progress'; id: number; progress: LessonProgress }
  | { type: 'ended'; id: number; progress: LessonProgress }
  | { type: 'refused'; id: number; error: Fault }
  | { type: 'answer'; id: number; answer: unknown }
  | { type: 'crashed'; message: string; stack: string }
  | { type: 'failed'; message: string };
export interface LessonClientOptions {
  spawn?: () => WorkerLike;
  /** of the present run, some fifty times a second */
  onProgress?: (progress: LessonProgress) => void;
}
