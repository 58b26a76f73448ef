/* tslint:disable */
/* eslint-disable */
import type {
    Answer,
    Code,
    Description,
    Fault,
    FieldAnswer,
    FieldRequest,
    FileRequest,
    ImageFacts,
    ImagePromise,
    MeshAnswer,
    MeshChange,
    Progress,
    FileRecord,
    Measured,
    Measures,
    Report,
    SolvedModel,
    Start,
} from '../../engine/core-types.js';


/**
 * A sampling session. Requests and answers are plain objects; columns are copies, three floats a
 * vector.
 */
export class Core {
    [Symbol.dispose](): void;
    /**
     * Adds a column of values at the particles, a formula or a function as [`Core::set_function`]
     * takes it, up to `budget` slices of the work. Returns undefined before it is there; then what
     * is wrong with the value, else null.
     */
    add_value(name: string, value: string | ((points: Float64Array, out: Float64Array) => void), budget: number): Fault | null | undefined;
    /**
     * The column of this name that was added; empty if there is none.
     */
    added_value(name: string): Float32Array<ArrayBuffer>;
    /**
     * Ends the run and keeps the particles: `Progress`.
     */
    cancel(): Progress;
    /**
     * Forgets the file that was opened last. The present field keeps its own.
     */
    close_opened(): void;
    /**
     * The program that makes the particles of the last run, in the language of this word (`rust`,
     * `js`, `python` or `shell`): an `Answer` with `Code`.
     */
    code(language: string): Answer<Code, string>;
    /**
     * How far the joined mesh is from the one that was opened, up to `budget` slices of the work:
     * `MeshChange` once it is known, undefined before; null where the surface is not that of a
     * mesh by itself.
     */
    compare(budget: number): MeshChange | null | undefined;
    /**
     * Component of each particle, 0 the largest, from the last report; 0xffffffff for none.
     */
    component(): Uint32Array<ArrayBuffer>;
    /**
     * A session on the default surface, with nothing sampled.
     */
    constructor();
    /**
     * Rows of the columns: particles, those on creases and seams once on each side.
     */
    count(): number;
    /**
     * Principal curvatures of particles from `from` on, two each, worked out now.
     */
    curvature(from: number): Float32Array<ArrayBuffer>;
    /**
     * The description of all settings, surfaces and figures: `Description`.
     */
    describe(): Description;
    /**
     * Digest of the particle columns, 16 hexadecimal digits.
     */
    digest(): string;
    /**
     * Energy of each particle among its natural neighbours, over that of six at the ideal
     * distance, as of the last report.
     */
    energy(): Float32Array<ArrayBuffer>;
    /**
     * Positions from particle `from` on, where single precision does not hold them: in a box far
     * from the origin. Elsewhere nothing.
     */
    exact_positions(from: number): Float64Array<ArrayBuffer>;
    /**
     * Finds the box of the next run with these `Settings` and the creases in it, up to `budget`
     * slices of the work: an `Answer` with `FieldAnswer` once it is known, nothing before. While a
     * slider moves the box `only_grows`.
     */
    fit(settings: Record<string, number | string>, only_grows: boolean, budget: number): Answer<FieldAnswer, Fault> | undefined;
    /**
     * Has the particles of the last run follow its surface to the present field, in the box that
     * [`Core::fit`] has found: whether they can, and the run had these `Settings`. `is_closed`: no
     * particle is born, and none dies but where it does not come to the surface.
     */
    follow(settings: Record<string, number | string>, is_closed: boolean): boolean;
    /**
     * Estimated share of the work that is done: of the run and of what is planned.
     */
    fraction(): number;
    free(): void;
    /**
     * What a file of an image promises that begins with these bytes, a megabyte of it or all: an
     * `Answer` with `ImagePromise`.
     */
    image_promise(name: string, start: Uint8Array | number[]): Answer<ImagePromise, Fault>;
    /**
     * Joins the particles to a mesh, up to `budget` slices of the work: `MeshAnswer` once it is
     * complete, nothing before.
     */
    join(budget: number): MeshAnswer | undefined;
    /**
     * Generation levels from particle `from` on.
     */
    levels(from: number): Uint32Array<ArrayBuffer>;
    /**
     * Refuses runs that need more than about `megabytes` with their report.
     */
    limit_memory(megabytes: number): void;
    /**
     * Measures these particles, up to `budget` slices of the work: `Report` once it is complete,
     * nothing before.
     */
    measure(measured: Measured, budget: number): Report | undefined;
    /**
     * Measures particles that something else has placed on the present surface, vectors of three
     * floats: `Measures`. The columns of the last report are then theirs.
     */
    measure_placed(positions: Float32Array | number[], normals: Float32Array | number[], radii: Float32Array | number[], is_adaptive: boolean): Measures;
    /**
     * The mesh as a file, with the record of what it was made from: `FileRequest`, up to `budget`
     * slices of the work; its bytes once it is complete, undefined before; null for another
     * extension or if it is too large.
     */
    mesh_file(request: Partial<FileRequest>, budget: number): Uint8Array<ArrayBuffer> | null | undefined;
    /**
     * Distance to the nearest particle, as of the last report.
     */
    nearest(): Float32Array<ArrayBuffer>;
    /**
     * Unit normals from particle `from` on.
     */
    normals(from: number): Float32Array<ArrayBuffer>;
    /**
     * The number that a text without names stands for in the language of formulas; nothing for any
     * other text.
     */
    number(text: string): number | undefined;
    /**
     * Opens a triangle mesh of arrays: the coordinates of its vertices, three each, and the
     * vertices of its faces, three each. Returns why it cannot be, else null.
     */
    open_faces(name: string, points: Float64Array | number[], faces: Uint32Array | number[]): Fault | null;
    /**
     * Opens a file of an image, for [`Core::set_opened`]: an `Answer` with `ImageFacts`. `beside`
     * gives the bytes of a file beside it by its name. After an error the last good image stays.
     */
    open_image(name: string, bytes: Uint8Array | number[], beside: (name: string) => Uint8Array | undefined): Answer<ImageFacts, Fault>;
    /**
     * Opens a file of a triangle mesh, for [`Core::set_opened`]. Returns why it cannot be, else
     * null. After an error the file before it stays open.
     */
    open_mesh(name: string, bytes: Uint8Array | number[]): Fault | null;
    /**
     * Opens an image of an array: the bytes of voxels of a type such as `int16`, of which the
     * index along the first axis changes fastest, and the affine map from indices to points, row
     * by row; an `Answer` with `ImageFacts`.
     */
    open_voxels(name: string, voxel_type: string, size: Uint32Array | number[], rows: Float64Array | number[], bytes: Uint8Array | number[]): Answer<ImageFacts, Fault>;
    /**
     * Parents from particle `from` on; 0xffffffff for a seed.
     */
    parents(from: number): Uint32Array<ArrayBuffer>;
    /**
     * For each row, the first row of the same particle: one on a crease has a row on each side.
     * Empty without creases.
     */
    particle(): Uint32Array<ArrayBuffer>;
    /**
     * The particles as a file with this extension, with what was measured of them and the record;
     * as `json` the record by itself. None for another extension or without a record.
     */
    particle_file(extension: string): Uint8Array<ArrayBuffer> | undefined;
    /**
     * Patch of each particle, by the number of its branch; empty without creases.
     */
    patch(): Uint32Array<ArrayBuffer>;
    /**
     * The column [`Particles::periodic`].
     */
    periodic(): Uint32Array<ArrayBuffer>;
    /**
     * Says what follows on the run, for the share of the work that is told: which particles will
     * be measured, and whether they will be joined.
     */
    plan(measured: Measured, is_joined: boolean): void;
    /**
     * Positions from particle `from` on, rounded to single precision.
     */
    positions(from: number): Float32Array<ArrayBuffer>;
    /**
     * Repulsion radii from particle `from` on.
     */
    radii(from: number): Float32Array<ArrayBuffer>;
    /**
     * The record of what the particles were made from, for their files: `FileRecord`; null before
     * the first run.
     */
    record(): FileRecord | null;
    /**
     * Queues relaxation steps on the present particles.
     */
    relax(steps: number): void;
    /**
     * |f|/|∇f| per particle, as of the last report.
     */
    residual(): Float32Array<ArrayBuffer>;
    /**
     * The pairs of rows between which a seam without an edge goes on, two each; none without
     * seams.
     */
    seams(): Uint32Array<ArrayBuffer>;
    /**
     * The pairs of rows between which a crease goes on, two each; none without creases.
     */
    segments(): Uint32Array<ArrayBuffer>;
    /**
     * Changes the field: `FieldRequest` to an `Answer` with `FieldAnswer`. After an error the last
     * good field stays.
     */
    set_field(request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a function that takes the coordinates of up to 512 points and an array
     * for f at each of them, to an `Answer` with `FieldAnswer`. With `labels` it takes the label
     * of a piece besides, and gives its values; `labels` writes the labels at points. Of the
     * `FieldRequest` the box counts. Once a function has thrown none is called again, and the run
     * ends.
     */
    set_function(_function: (points: Float64Array, out: Float64Array, piece?: number) => void, request: Partial<FieldRequest>, labels?: (points: Float64Array, out: Uint32Array) => void): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a surface of the file that was opened last: of a `FieldRequest` the
     * parameters that choose it count, of an image `iso`, `label`, `smooth` and `dark` and of a
     * mesh `edges` and `smooth`, the box, and a formula with the surface as an operand; to an
     * `Answer` with `FieldAnswer`. After an error the last good field stays.
     */
    set_opened(request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a model from points: the solved system as `Points.field` gives it, what
     * `Points.info` says of it, `SolvedModel`, and a `FieldRequest`, of which the box, the pulls
     * and a formula with the model as an operand count; to an `Answer` with `FieldAnswer`. After
     * an error the last good field stays.
     */
    set_points(system: Uint8Array | number[], about: SolvedModel, request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * The fates of the slots, three bits each, from particle `from` on: six, or up to ten of an
     * adaptive particle. Bit 30 marks a singular point nearby.
     */
    slots(from: number): Uint32Array<ArrayBuffer>;
    /**
     * Chooses the distance between neighbours for the next runs: a formula, or a function as
     * [`Core::set_function`] takes it. Returns what is wrong with the formula, else null.
     */
    space(spacing: string | ((points: Float64Array, out: Float64Array) => void)): Fault | null;
    /**
     * Starts a run: `Settings`, of which what is missing has its default; to an `Answer` with
     * `Start`.
     */
    start(settings: Record<string, number | string>): Answer<Start, Fault>;
    /**
     * Does up to `budget` units of work: `Progress`.
     */
    step(budget: number): Progress;
    /**
     * What is wrong with the formula of a `thickness`, a `spacing` or a `value` on the present
     * surface; nothing if it is right.
     */
    text_fault(what: 'thickness' | 'spacing' | 'value', text: string): string | undefined;
    /**
     * The triangles of the mesh, three rows each, counter-clockwise round their normals; none
     * before it is complete.
     */
    triangles(): Uint32Array<ArrayBuffer>;
    /**
     * For the rows of particles on creases, seams and tips, which come first, the first row of the
     * same particle; nothing without any.
     */
    twins(): Uint32Array<ArrayBuffer>;
    /**
     * Natural neighbours per particle, as of the last report.
     */
    valence(): Uint8Array<ArrayBuffer>;
    /**
     * The names of the columns that were added.
     */
    value_names(): string[];
    /**
     * A session whose first formula is that of no surface of the gallery, whatever its text.
     */
    static without_surface(): Core;
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
