/* tslint:disable */
/* eslint-disable */

/**
 * Draws particles on a canvas. Call `free()` when done. After the device is lost, create a new
 * renderer on a new canvas.
 */
export class Renderer {
    [Symbol.dispose](): void;
    /**
     * Name of the graphics adapter according to the driver; may be empty, since browsers hide it.
     */
    adapter(): string;
    /**
     * "webgpu" or "webgl2".
     */
    backend(): string;
    /**
     * Opens a graphics device on `canvas`, which must not have a context of another kind.
     *
     * `on_lost(reason, message)` is called once, when the device is lost; reason is "unknown" or
     * "destroyed". `on_error(message)` is called when the device rejects a call; drawing
     * continues. Both are called after the causing method has returned, and may use the renderer.
     *
     * # Errors
     *
     * Throws an `Error` if the canvas, the adapter or the device is not available.
     */
    static create(canvas: HTMLCanvasElement, on_lost: (reason: string, message: string) => void, on_error: (message: string) => void): Promise<Renderer>;
    /**
     * Releases the device and its memory; later calls do nothing. `on_lost` gets "destroyed".
     */
    destroy(): void;
    /**
     * Draws one picture on the canvas. Returns "drawn", "skipped" (nothing to draw on now) or
     * "lost" (create a new renderer).
     */
    draw(time_s: number): string;
    free(): void;
    /**
     * Largest number of faces that `write_faces` takes.
     */
    max_faces(): number;
    /**
     * Largest number of particles that `write` takes.
     */
    max_particles(): number;
    /**
     * The `[width, height]` that `read_pixels` draws for a wanted size: the same size, unless the
     * device cannot.
     */
    picture_size(width_px: number, height_px: number): Uint32Array<ArrayBuffer>;
    private constructor();
    /**
     * Draws the picture into a texture of `picture_size(width_px, height_px)`, with every particle
     * fully shown. Resolves to its pixels: rows from top to bottom, red, green, blue, opacity (not
     * premultiplied), sRGB. Rejects if the device is lost.
     */
    read_pixels(width_px: number, height_px: number, transparent: boolean): Promise<Uint8Array<ArrayBuffer>>;
    /**
     * Sets the canvas's size in pixels. Beyond the device's limit it shrinks in proportion (read
     * `canvas.width` after the next `draw`). If a side is 0 nothing is drawn.
     */
    resize(width_px: number, height_px: number): void;
    /**
     * Sets how many particles are drawn, and how many form the body beneath them. The body is
     * fainter where its particles are not drawn.
     */
    set_count(count: number, body: number): void;
    /**
     * Sets how many faces are drawn, if the style asks for faces, and how many particles they
     * replace. Without faces discs are drawn.
     */
    set_faces(count: number, particles: number): void;
    /**
     * Sets the look from a JSON object. Missing keys take their defaults, unknown ones are
     * ignored.
     *
     * `background` [r, g, b, a] · `faces` {flat, edge_px} or null for discs · `body` {colour,
     * is_open, bounds: {min, max}} beneath them or null · `spheres` instead of discs ·
     * `disc_scale` · `key_light_view` [x, y, z] · `dim` · `dim_backfaces` · `occlusion` · `warmth`
     * · `fade_s` · `level` newest generation level drawn, null for all · `outline` index of the
     * particle with a ring, negative for none · `box` {min, max, colour} or null · `plane`
     * {normal, offset}, which hides the side of its normal, or null · `pixel_ratio`. Meaning,
     * units and defaults: `render::style::Style`.
     *
     * # Errors
     *
     * Throws for malformed JSON and for values of another type; the last style stays.
     */
    set_style(json: string): void;
    /**
     * Sets the camera: clip from world (16, column-major, depth 0 to 1), eye (3) and viewing
     * direction (3) in world coordinates. Further numbers are ignored. The matrix tells whether
     * the camera is orthographic.
     *
     * # Errors
     *
     * Throws for fewer than 22 numbers or a number that is not finite; the last camera stays.
     */
    set_view(view: Float32Array | number[]): void;
    /**
     * Changes the colours of faces from `first` on and of their marks, three each.
     *
     * # Errors
     *
     * As for `write_faces`.
     */
    tint_faces(first: number, colours: Uint32Array, marks: Uint32Array): void;
    /**
     * Appends or overwrites particles `first..first + radii.length`. The number of particles drawn
     * grows to include them.
     *
     * `positions` and `normals` have three numbers per particle. A negative radius means a dot
     * that faces the eye; the level 4294967295 means no level, and such a particle is always
     * drawn; `colours` are 0xAABBGGRR, sRGB. The particles begin to appear at `birth_s` on the
     * clock of `draw`; -Infinity shows them at once.
     *
     * # Errors
     *
     * Throws if the columns differ in length or there are more particles than `max_particles()`.
     */
    write(first: number, positions: Float32Array, normals: Float32Array, radii: Float32Array, levels: Uint32Array, colours: Uint32Array, birth_s: number): void;
    /**
     * Changes the colours of particles from `first` on.
     *
     * # Errors
     *
     * Throws if there are more particles than `max_particles()`.
     */
    write_colours(first: number, colours: Uint32Array): void;
    /**
     * Writes faces from `first` on. Each face has three corners, counter-clockwise seen from
     * outside, with the data of a particle in `write`. `marks` are the colours of marks on the
     * corners, 0 for none. Pass some ten thousand faces at a time.
     *
     * # Errors
     *
     * Throws if the columns differ in length or there are more faces than `max_faces()`.
     */
    write_faces(first: number, positions: Float32Array, normals: Float32Array, radii: Float32Array, levels: Uint32Array, colours: Uint32Array, marks: Uint32Array): void;
    /**
     * Replaces the crease segments. `ends` has eight numbers for each, the position of both ends
     * with the radius of the particle there; `colours` are 0xAABBGGRR, sRGB.
     *
     * # Errors
     *
     * Throws if the columns differ in length or there are more segments than `max_particles()`.
     */
    write_lines(ends: Float32Array, colours: Uint32Array): void;
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
