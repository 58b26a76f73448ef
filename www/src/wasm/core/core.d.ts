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
 * A sampling session. Requests and answers are plain objects; columns are copies, with three
 * floats per vector.
 */
export class Core {
    [Symbol.dispose](): void;
    /**
     * Appends bytes to the file that was begun.
     */
    add_bytes(bytes: Uint8Array | number[]): void;
    /**
     * Adds a column of values at the particles, from a formula or a function like that of
     * [`Core::set_function`], doing up to `budget` slices of the work. Returns undefined until it
     * is complete; then the error in the value, else null.
     */
    add_value(name: string, value: string | ((points: Float64Array, out: Float64Array) => void), budget: number): Fault | null | undefined;
    /**
     * The added column of this name; empty if there is none.
     */
    added_value(name: string): Float32Array<ArrayBuffer>;
    /**
     * Begins a file of this size, whose bytes [`Core::add_bytes`] appends. One that has been begun
     * is forgotten.
     */
    begin_file(size: number): void;
    /**
     * Ends the run and keeps the particles: `Progress`.
     */
    cancel(): Progress;
    /**
     * Forgets the last opened file. The present field keeps its own copy.
     */
    close_opened(): void;
    /**
     * A program that makes the particles of the last run, in a language (`rust`, `js`, `python` or
     * `shell`): an `Answer` with `Code`.
     */
    code(language: string): Answer<Code, string>;
    /**
     * Replaces the `count` fields that were kept last by their combination. A smooth union has the
     * width `by`, an offset that distance. A `difference` and a `smoothUnion` take two fields, an
     * `offset` one.
     *
     * # Panics
     *
     * If there is no such combination of so many fields.
     */
    combine(how: 'union' | 'intersection' | 'difference' | 'smoothUnion' | 'offset', count: number, by: number): void;
    /**
     * The distance of the joined mesh from the opened one, doing up to `budget` slices of the
     * work: `MeshChange` once complete, undefined before; null unless the surface is that of a
     * mesh without a formula.
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
     * Rows of the columns: one per particle, and one per side for particles on creases and smooth
     * joins.
     */
    count(): number;
    /**
     * Principal curvatures of particles from `from` on, two each, computed by this call.
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
     * distance, from the last report.
     */
    energy(): Float32Array<ArrayBuffer>;
    /**
     * Positions from particle `from` on, if single precision is not enough: in a box far from the
     * origin. Otherwise empty.
     */
    exact_positions(from: number): Float64Array<ArrayBuffer>;
    /**
     * Finds the box of the next run with these `Settings` and the creases in it, doing up to
     * `budget` slices of the work: an `Answer` with `FieldAnswer` once complete, nothing before.
     * While a slider moves, the box `only_grows`.
     */
    fit(settings: Record<string, number | string>, only_grows: boolean, budget: number): Answer<FieldAnswer, Fault> | undefined;
    /**
     * Moves the particles of the last run along with its surface to the present field, in the box
     * from [`Core::fit`]. Returns whether that is possible and the run had these `Settings`.
     * `is_closed`: no particle is born, and one dies only if it does not reach the surface.
     */
    follow(settings: Record<string, number | string>, is_closed: boolean): boolean;
    /**
     * Estimated share of the work that is done, of the run and of what is planned.
     */
    fraction(): number;
    free(): void;
    /**
     * The size and type of the image in a file, and the memory that it needs, from the first
     * megabyte of the file or all its bytes: an `Answer` with `ImagePromise`.
     */
    image_promise(name: string, start: Uint8Array | number[]): Answer<ImagePromise, Fault>;
    /**
     * Joins the particles to a mesh, doing up to `budget` slices of the work: `MeshAnswer` once
     * complete, nothing before.
     */
    join(budget: number): MeshAnswer | undefined;
    /**
     * Keeps the present field, for [`Core::combine`].
     */
    keep(): void;
    /**
     * Keeps one voxel in `step` along each axis of the image in the file that was begun.
     */
    keep_one_in(step: number): void;
    /**
     * Generation levels from particle `from` on.
     */
    levels(from: number): Uint32Array<ArrayBuffer>;
    /**
     * Refuses runs that need more than about `megabytes`, including their report.
     */
    limit_memory(megabytes: number): void;
    /**
     * Does up to `budget` slices of the work of [`Core::set_opened`] with this request, which then
     * takes what is made. Returns the share that is done, 1 at the end, also after an error. A
     * call with another choice begins again.
     */
    make_opened(request: Partial<FieldRequest>, budget: number): number;
    /**
     * Keeps the edges of the last opened mesh along these segments sharp, six numbers each, in the
     * next field that is set; none keeps those that its angle tells. Does nothing for an image.
     */
    mark_edges(segments: Float64Array | number[]): void;
    /**
     * Measures these particles, doing up to `budget` slices of the work: `Report` once complete,
     * nothing before.
     */
    measure(measured: Measured, budget: number): Report | undefined;
    /**
     * Measures particles placed on the present surface by other means, three floats per vector:
     * `Measures`. The columns of the last report then belong to them.
     */
    measure_placed(positions: Float32Array | number[], normals: Float32Array | number[], radii: Float32Array | number[], is_adaptive: boolean): Measures;
    /**
     * The three vertices of each of its faces, counter-clockwise seen from outside.
     */
    mesh_faces(): Uint32Array<ArrayBuffer>;
    /**
     * The mesh as a file with its record, from a `FileRequest`, doing up to `budget` slices of the
     * work: its bytes once complete, undefined before; null for an unknown extension or if it is
     * too large.
     */
    mesh_file(request: Partial<FileRequest>, budget: number): Uint8Array<ArrayBuffer> | null | undefined;
    /**
     * Three coordinates for each vertex of the last opened mesh, as it was repaired; empty for an
     * image.
     */
    mesh_vertices(): Float64Array<ArrayBuffer>;
    /**
     * Distance to the nearest particle, from the last report.
     */
    nearest(): Float32Array<ArrayBuffer>;
    /**
     * Unit normals from particle `from` on.
     */
    normals(from: number): Float32Array<ArrayBuffer>;
    /**
     * The value of a text without names in the language of formulas; nothing for any other text.
     */
    number(text: string): number | undefined;
    /**
     * Opens a triangle mesh from arrays: three coordinates per vertex, and three vertices per
     * face. Returns the reason if that fails, else null.
     */
    open_faces(name: string, points: Float64Array | number[], faces: Uint32Array | number[]): Fault | null;
    /**
     * Begins to open the image in the file whose bytes have been added. [`Core::open_step`] does
     * the work. `beside` returns the bytes of another file by name.
     */
    open_image(name: string, beside: (name: string) => Uint8Array | undefined): void;
    /**
     * Begins to open the triangle mesh in the file whose bytes have been added, for
     * [`Core::set_opened`]. [`Core::open_step`] does the work.
     */
    open_mesh(name: string): void;
    /**
     * Does up to `budget` slices of the work of opening a file, for [`Core::set_opened`]. Returns
     * the share that is done; at the end an `Answer`, of an image with `ImageFacts`. After an
     * error the last valid file stays.
     */
    open_step(budget: number): number | Answer<ImageFacts | object, Fault>;
    /**
     * Opens an image from an array: the bytes of voxels of a type such as `int16`, the index along
     * the first axis changing fastest, and the affine map from indices to points, row by row.
     * Returns the reason if that fails, else null.
     */
    open_voxels(name: string, voxel_type: string, size: Uint32Array | number[], rows: Float64Array | number[], bytes: Uint8Array | number[]): Fault | null;
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
     * Patch of each particle, as the number of its branch; empty without creases.
     */
    patch(): Uint32Array<ArrayBuffer>;
    /**
     * The column [`Particles::periodic`].
     */
    periodic(): Uint32Array<ArrayBuffer>;
    /**
     * Announces what follows the run, for the estimate of the work: which particles will be
     * measured, and whether they will be joined.
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
     * The record for the files of the particles: `FileRecord`; null before the first run.
     */
    record(): FileRecord | null;
    /**
     * Queues relaxation steps on the present particles.
     */
    relax(steps: number): void;
    /**
     * |f|/|∇f| per particle, from the last report.
     */
    residual(): Float32Array<ArrayBuffer>;
    /**
     * The pairs of rows that a smooth join connects, two numbers each; empty without them.
     */
    seams(): Uint32Array<ArrayBuffer>;
    /**
     * The voxels of the image in a plane: at `place`, nine numbers for a corner and the steps
     * along two directions, with so many points along these. NaN outside the image; empty without
     * one.
     */
    section(place: Float64Array | number[], width: number, height: number): Float32Array<ArrayBuffer>;
    /**
     * The pairs of rows that a crease connects, two numbers each; empty without creases.
     */
    segments(): Uint32Array<ArrayBuffer>;
    /**
     * Changes the field: takes a `FieldRequest`, returns an `Answer` with `FieldAnswer`. After an
     * error the last valid field stays.
     */
    set_field(request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a function that takes the coordinates of up to 512 points and an array
     * for f at each of them. Returns an `Answer` with `FieldAnswer`. With `labels`, the function
     * also takes the label of a piece, whose values it writes; `labels` writes the labels at
     * points. Only the box of the `FieldRequest` is used. After a function has thrown, none is
     * called again, and the run ends.
     */
    set_function(_function: (points: Float64Array, out: Float64Array, piece?: number) => void, request: Partial<FieldRequest>, labels?: (points: Float64Array, out: Uint32Array) => void): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to the one that was kept last. Of the `FieldRequest` the box counts, and a
     * formula with the field as an operand. Returns an `Answer` with `FieldAnswer`. After an error
     * the last valid field stays.
     *
     * # Panics
     *
     * If no field was kept.
     */
    set_kept(request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a surface of the last opened file. A `FieldRequest` gives the file's
     * parameters (`iso`, `label`, `smooth`, `dark` and `closed` of an image, `edges`, `borders`
     * and `smooth` of a mesh), the box, and a formula with the surface as an operand. Returns an
     * `Answer` with `FieldAnswer`. After an error the last valid field stays.
     */
    set_opened(request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * Changes the field to a model from points. `system` is the result of `Points.field`, with the
     * `SolvedModel` from `Points.info`; of the `FieldRequest` the box, the pulls and a formula
     * with the model as an operand count. Returns an `Answer` with `FieldAnswer`. After an error
     * the last valid field stays.
     */
    set_points(system: Uint8Array | number[], about: SolvedModel, request: Partial<FieldRequest>): Answer<FieldAnswer, Fault>;
    /**
     * The fates of the slots, three bits each, from particle `from` on: six, or up to ten of an
     * adaptive particle. Bit 30 marks a nearby singular point.
     */
    slots(from: number): Uint32Array<ArrayBuffer>;
    /**
     * Chooses the distance between neighbours for the next runs: a formula, or a function like
     * that of [`Core::set_function`]. Returns the error in the formula, else null.
     */
    space(spacing: string | ((points: Float64Array, out: Float64Array) => void)): Fault | null;
    /**
     * Starts a run with `Settings`, in which missing ones have their defaults. Returns an `Answer`
     * with `Start`.
     */
    start(settings: Record<string, number | string>): Answer<Start, Fault>;
    /**
     * Does up to `budget` units of work: `Progress`.
     */
    step(budget: number): Progress;
    /**
     * The error in the formula of a `thickness`, a `spacing` or a `value` on the present surface;
     * nothing if it is valid.
     */
    text_fault(what: 'thickness' | 'spacing' | 'value', text: string): string | undefined;
    /**
     * The triangles of the mesh, three rows each, counter-clockwise around their normals; none
     * before it is complete.
     */
    triangles(): Uint32Array<ArrayBuffer>;
    /**
     * For rows of particles on creases, smooth joins and tips, which come first, the first row of
     * the same particle; empty without any.
     */
    twins(): Uint32Array<ArrayBuffer>;
    /**
     * Number of natural neighbours per particle, from the last report.
     */
    valence(): Uint8Array<ArrayBuffer>;
    /**
     * The names of the added columns.
     */
    value_names(): string[];
    /**
     * A session whose first formula is treated as that of no gallery surface, whatever its text.
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
