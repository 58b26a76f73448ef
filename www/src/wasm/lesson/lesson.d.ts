/* tslint:disable */
/* eslint-disable */
import type {
    Answer,
    Bounds,
    Fault,
    LessonChapter,
    LessonEvent,
    LessonField,
    LessonIterate,
    LessonLife,
    LessonProgress,
    LessonSettings,
    Pull,
} from '../../engine/core-types.js';


/**
 * The paper's algorithms, event by event. Requests and answers are plain objects; columns are
 * copies.
 */
export class Lesson {
    [Symbol.dispose](): void;
    /**
     * The chapters from number `first` on: an array of `LessonChapter`.
     */
    chapters(first: number): LessonChapter[];
    /**
     * A lesson without a run.
     */
    constructor();
    /**
     * Digest of the particles at the sought moment, 16 hexadecimal digits.
     */
    digest(): string;
    /**
     * 1 for a particle that is done, 0 for one that waits.
     */
    done(): Uint8Array<ArrayBuffer>;
    /**
     * Up to `count` events from number `first` on: an array of `LessonEvent`.
     */
    events(first: number, count: number): LessonEvent[];
    free(): void;
    /**
     * Numbers of the fronts.
     */
    fronts(): Uint32Array<ArrayBuffer>;
    /**
     * Generation levels.
     */
    levels(): Uint32Array<ArrayBuffer>;
    /**
     * The events at which a particle was added, treated and done: `LessonLife`; null if there is
     * no such particle.
     */
    life(particle: number): LessonLife | null;
    /**
     * The steps of Newton's method in space from a point: an array of `LessonIterate`.
     */
    newton(start: Float64Array | number[], reach: number): LessonIterate[];
    /**
     * Unit normals, three floats each.
     */
    normals(): Float32Array<ArrayBuffer>;
    /**
     * Parents; 0xffffffff for a seed.
     */
    parents(): Uint32Array<ArrayBuffer>;
    /**
     * Positions at the sought moment, three floats each.
     */
    positions(): Float32Array<ArrayBuffer>;
    /**
     * Repulsion radii.
     */
    radii(): Float32Array<ArrayBuffer>;
    /**
     * The curve f = 0 in the plane of `centre` and two perpendicular unit vectors, within `half`
     * of the centre: segments as four floats each, x along `right` and y along `up`.
     */
    section(centre: Float64Array | number[], right: Float64Array | number[], up: Float64Array | number[], half: number, cells: number): Float32Array<ArrayBuffer>;
    /**
     * Goes to the moment before event number `event`; returns the number of events before that
     * moment.
     */
    seek(event: number): number;
    /**
     * Three-bit fates of the slots, as in the sampler.
     */
    slots(): Uint32Array<ArrayBuffer>;
    /**
     * Begins a run on a formula, and drops the previous one: takes `LessonField` and
     * `LessonSettings`, possibly partial; returns an `Answer` with `LessonProgress`.
     */
    start(field: LessonField, settings: Partial<LessonSettings>): Answer<LessonProgress, Fault>;
    /**
     * Begins a run on a model from points: `system` is the result of `Points.field`, `pulls` are
     * those on its surface, and `bounds` is its `Bounds`. Returns an `Answer` with
     * `LessonProgress`.
     */
    start_points(system: Uint8Array | number[], pulls: readonly Pull[], bounds: Bounds, settings: Partial<LessonSettings>): Answer<LessonProgress, Fault>;
    /**
     * Does up to `budget` units of work: `LessonProgress`; null before a run.
     */
    step(budget: number): LessonProgress | null;
}

export type InitInput = RequestInfo | URL | Response | BufferSource | WebAssembly.Module;

export interface InitOutput {
    readonly memory: WebAssembly.Memory;
}

export type SyncInitInput = BufferSource | WebAssembly.Module;

/**
 * Instantiates the given `module`, which can either be bytes or
 * a precompiled `WebAssembly.Module`.
 *
 * @param {{ module: SyncInitInput }} module - Passing `SyncInitInput` directly is deprecated.
 *
 * @returns {InitOutput}
 */
export function initSync(module: { module: SyncInitInput } | SyncInitInput): InitOutput;

/**
 * If `module_or_path` is {RequestInfo} or {URL}, makes a request and
 * for everything else, calls `WebAssembly.instantiate` directly.
 *
 * @param {{ module_or_path: InitInput | Promise<InitInput> }} module_or_path - Passing `InitInput` directly is deprecated.
 *
 * @returns {Promise<InitOutput>}
 */
export default function __wbg_init (module_or_path?: { module_or_path: InitInput | Promise<InitInput> } | InitInput | Promise<InitInput>): Promise<InitOutput>;
