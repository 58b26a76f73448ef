/* tslint:disable */
/* eslint-disable */

/**
 * Draws particles on a canvas. `free()` it when done; a lost device needs a new renderer on a new
 * canvas.
 */
export class Renderer {
    [Symbol.dispose](): void;
    /**
     * Name of the graphics adapter as the driver gives it; may be empty, since browsers hide it.
     */
    adapter(): string;
    /**
     * "webgpu" or "webgl2".
     */
    backend(): string;
    /**
     * Opens a graphics device on `canvas`, which must have no context of another kind yet.
     *
     * `on_lost(reason, message)` is called once, when the device is gone; reason is "unknown" or
     * "destroyed". `on_error(message)` is called when the device refuses a call; drawing goes on.
     * Both are called after the method that caused them has returned, and may use the renderer.
     *
     * # Errors
     *
     * Throws an `Error` where the canvas, the adapter or the device cannot be had.
     */
    static create(canvas: HTMLCanvasElement, on_lost: (reason: string, message: string) => void, on_error: (message: string) => void): Promise<Renderer>;
    /**
     * Gives the device and its memory back; later calls do nothing. `on_lost` hears "destroyed".
     */
    destroy(): void;
    /**
     * Draws one picture on the canvas: "drawn", "skipped" (nothing to draw on now) or "lost" (make
     * a new renderer).
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
     * `[width, height]` that `read_pixels` draws for a wanted size: the wanted one unless the
     * device cannot.
     */
    picture_size(width_px: number, height_px: number): Uint32Array<ArrayBuffer>;
    private constructor();
    /**
     * Draws the picture into a texture of `picture_size(width_px, height_px)`, with every particle
     * fully shown, and resolves to its pixels: rows from top to bottom, red, green, blue, opacity
     * (not multiplied in), sRGB. Rejects where the device is lost.
     */
    read_pixels(width_px: number, height_px: number, transparent: boolean): Promise<Uint8Array<ArrayBuffer>>;
    /**
     * Sets the canvas's size in pixels. Beyond the device's limit it shrinks in proportion (read
     * `canvas.width` after the next `draw`); where a side is 0 nothing is drawn.
     */
    resize(width_px: number, height_px: number): void;
    /**
     * Draws the first `count` particles from now on, and the first `body` ones as the body beneath
     * them: fainter those that are not drawn.
     */
    set_count(count: number, body: number): void;
    /**
     * Draws the first `count` faces from now on, where the style asks for faces, in the place of
     * the first `particles` particles. Without faces there are discs.
     */
    set_faces(count: number, particles: number): void;
    /**
     * Sets the look from a JSON object; missing keys take their defaults, unknown ones are
     * ignored.
     *
     * `background` [r, g, b, a] · `faces` {flat, edge_px} or null for discs · `body` {colour,
     * is_open, bounds: {min, max}} beneath them or null · `spheres` in the place of discs ·
     * `disc_scale` · `key_light_view` [x, y, z] · `dim` · `dim_backfaces` · `occlusion` · `warmth`
     * · `fade_s` · `level` newest generation level drawn, null for all · `outline` index of the
     * particle with a ring around it, negative for none · `box` {min, max, colour} or null ·
     * `plane` {normal, offset} that hides what its normal points to, or null · `pixel_ratio`.
     * Meaning, units and defaults: `render::style::Style`.
     *
     * # Errors
     *
     * Throws for malformed JSON and for values of another type; the last style stays.
     */
    set_style(json: string): void;
    /**
     * Sets the camera: clip from world (16, column-major, depth 0 to 1), eye (3) and viewing
     * direction (3) in world coordinates. Further numbers are ignored; whether the camera is
     * orthographic follows from the matrix.
     *
     * # Errors
     *
     * Throws for fewer than 22 numbers and for a number that is not finite; the last camera stays.
     */
    set_view(view: Float32Array | number[]): void;
    /**
     * Changes the colours of faces from `first` on, and those of their marks, three each.
     *
     * # Errors
     *
     * The errors of `write_faces`.
     */
    tint_faces(first: number, colours: Uint32Array, marks: Uint32Array): void;
    /**
     * Appends or overwrites particles `first..first + radii.length`; the number drawn grows to
     * their end.
     *
     * Three numbers per particle in `positions` and `normals`; a negative radius is that of a dot
     * that faces the eye; a level of 4294967295 stands for none, and such a particle is always
     * drawn; `colours` are 0xAABBGGRR, sRGB. They begin to appear at `birth_s` on the clock of
     * `draw`; -Infinity shows them at once.
     *
     * # Errors
     *
     * Throws where the columns disagree in length or there are more particles than
     * `max_particles()`.
     */
    write(first: number, positions: Float32Array, normals: Float32Array, radii: Float32Array, levels: Uint32Array, colours: Uint32Array, birth_s: number): void;
    /**
     * Changes the colours of particles from `first` on.
     *
     * # Errors
     *
     * Throws where there are more particles than `max_particles()`.
     */
    write_colours(first: number, colours: Uint32Array): void;
    /**
     * Writes faces from `first` on: of each corner what `write` takes of a particle, three corners
     * a face, counter-clockwise seen from outside. `marks` are the colours of marks on the
     * corners, 0 for none. Hand over some ten thousand at a time.
     *
     * # Errors
     *
     * Throws where the columns disagree in length or there are more faces than `max_faces()`.
     */
    write_faces(first: number, positions: Float32Array, normals: Float32Array, radii: Float32Array, levels: Uint32Array, colours: Uint32Array, marks: Uint32Array): void;
    /**
     * Draws these pieces of creases from now on: eight numbers each in `ends`, the position of
     * either end and the radius of the particle there; `colours` are 0xAABBGGRR, sRGB.
     *
     * # Errors
     *
     * Throws where the columns disagree in length or there are more of them than
     * `max_particles()`.
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
