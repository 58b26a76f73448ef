/* tslint:disable */
/* eslint-disable */
import type {
    Answer,
    PointsProgress,
    SolvedModel,
} from '../../engine/core-types.js';


/**
 * Solver that makes a field from a built-in model or a file of points. Answers are plain objects.
 */
export class Points {
    [Symbol.dispose](): void;
    /**
     * Positions of the centres, three floats each; none before they are chosen.
     */
    centres(): Float32Array<ArrayBuffer>;
    /**
     * A solver without a job.
     */
    constructor();
    /**
     * The field for `Core.set_points`; empty until it is solved.
     */
    field(): Uint8Array<ArrayBuffer>;
    /**
     * Begins a file, and drops the previous job: an `Answer` with `PointsProgress`. `name` is for
     * reports. 0 centres mean their default number.
     */
    file(name: string, bytes: Uint8Array | number[], centres: number): Answer<PointsProgress, string>;
    free(): void;
    /**
     * The report on the model: an `Answer` with `SolvedModel`.
     */
    info(): Answer<SolvedModel, string>;
    /**
     * Begins a built-in model, and drops the previous job: an `Answer` with `PointsProgress`. 0
     * centres mean their default number.
     */
    model(id: string, centres: number): Answer<PointsProgress, string>;
    /**
     * Does up to `budget` slices of work: an `Answer` with `PointsProgress`.
     */
    step(budget: number): Answer<PointsProgress, string>;
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
