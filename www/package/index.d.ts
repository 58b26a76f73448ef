// What the package `marching-particles` gives a program.
/// <reference lib="esnext.disposable" />

export interface Bounds {
  min: [number, number, number];
  max: [number, number, number];
}
export interface Progress {
  /**
   * `seeding`, `generation`, `search`, `relaxation`, `refinement`, and `measuring` for the report
   */
  phase: string;
  particles: number;
  /** share of the work that is done, that of the report included */
  fraction: number;
}
export interface Options {
  /**
   * wanted number of particles, met within 3 %. Where no size is given it is 20,000; adaptive
   * particles keep close to the surface then
   */
  count?: number;
  /** half of the distance between neighbours, as a share of the box diagonal: 0.0001 to 0.2 */
  radius?: number;
  /** the distance between neighbours, in the units of the field */
  spacing?: number;
  /** the box that is sampled; without it one that fits the surface */
  bounds?: Bounds;
  /** of points: whether their surface ends at their border, as it does without it, or goes on */
  beyondPoints?: 'cut' | 'kept';
  /**
   * of points: a formula that names their surface `model`, as an operand of max, min, smin, smax or
   * abs, or with a number that is added: `max(model, z)` cuts it
   */
  formula?: string;
  /** values of the names in the formula */
  params?: Record<string, number>;
  /** whether particles are small where the surface bends and large where it is flat */
  adaptive?: boolean;
  /** `refined` takes longer and is more even */
  method?: 'front' | 'refined';
  seed?: number;
  /** whether a report is made, which takes about as long as the sampling; true without it */
  measure?: boolean;
  /** ends the sampling, whose promise is rejected with the signal's reason */
  signal?: AbortSignal;
  onProgress?: (progress: Progress) => void;
}
export interface Warning {
  /** a name by which a program tells warnings apart */
  code: string;
  /**
   * `note`: nothing needs to be done; `caution`: the result may be incomplete; `fault`: a part is
   * missing or wrong
   */
  severity: 'note' | 'caution' | 'fault';
  message: string;
}
export interface Report {
  count: number;
  /** the same for the same formula, options and version, on every machine */
  digest: string;
  warnings: Warning[];
  /** repulsion radius, in the units of the formula */
  radius: number;
  components: number | null;
  [figure: string]: unknown;
}
export interface Mesh {
  /** three rows of the sample's columns for each triangle, counter-clockwise seen from outside */
  indices: Uint32Array;
  /** what a closed mesh encloses; null where it is open */
  volume: number | null;
  components: { triangles: number; euler: number; open_edges: number }[];
  /** number of particles in no triangle */
  leftOut: number;
}
export type Format = 'glb' | '3mf' | 'stl' | 'obj' | 'ply';

export interface Sample {
  /** rows of the columns; a particle on a crease or a seam has one on each side of it */
  readonly count: number;
  /** three values for each row; in double precision where the box is far from the origin */
  readonly positions: Float32Array | Float64Array;
  readonly normals: Float32Array;
  readonly radii: Float32Array;
  /** generation levels, and the row of the parent, 0xffffffff for a seed */
  readonly levels: Uint32Array;
  readonly parents: Uint32Array;
  /** null with `measure: false` */
  readonly report: Report | null;
  readonly warnings: Warning[];
  readonly bounds: Bounds;
  readonly params: Record<string, number>;
  readonly digest: string;
  /**
   * joins the particles to triangles; with `weld` those at a crease or a seam share a row, and have
   * the normal of one side
   */
  mesh(how?: { weld?: boolean }): Promise<Mesh>;
  /** the mesh as a file */
  toFile(format: Format): Promise<Uint8Array<ArrayBuffer>>;
  /**
   * the particles on the surface of other parameters; they leave this sample, whose columns stay,
   * and are gone where there is no such surface or the signal ends it
   */
  moved(params: Record<string, number>, options?: Pick<Options, 'signal' | 'onProgress'>): Promise<Sample>;
  /**
   * frees the memory of the worker, once the meshes and files that were asked for are made; the
   * columns stay
   */
  dispose(): void;
  [Symbol.dispose](): void;
}

/** A function of many points at once. */
export interface Batch {
  /** writes f at each point to `out`; `xyz` has three numbers for each of its values */
  batch(xyz: Float64Array, out: Float64Array): void;
}
/** Points of a surface, three numbers each, and their outward normals if they are known. */
export interface Points {
  points: Float32Array | Float64Array | number[];
  normals?: Float32Array | Float64Array | number[];
}
/**
 * What is sampled: a formula such as `x^2 + y^2 + z^2 = a`; a function f(x, y, z), negative inside
 * and NaN where it has no value, of a point or of many at once; or points.
 */
export type Field = string | ((x: number, y: number, z: number) => number) | Batch | Points;

/**
 * Covers the surface f = 0 with evenly spaced particles. Formulas and points are sampled in a
 * worker; a function is called in the thread that it belongs to, in slices of some milliseconds
 * between which the page draws.
 */
export function sample(field: Field, options?: Options): Promise<Sample>;

/** An argument or an option is not what it has to be. */
export class InputError extends Error {}
/** The formula has a mistake between `start` and `end`, in UTF-16 code units. */
export class FormulaError extends Error {
  readonly start: number;
  readonly end: number;
  /**
   * a text for that place, where one would mend it; `choices`: several, each with another meaning
   */
  readonly suggestion: string | null;
  readonly choices: string[];
}
/**
 * The function that is sampled threw, which is the `cause`, or returned something else than its
 * values.
 */
export class FieldError extends Error {}
/** No particle could be placed. */
export class NoSurfaceError extends Error {}
/** The sample was disposed of, or its particles have moved on with another one. */
export class DisposedError extends Error {}
/** The worker has not started, or it has failed. The next sampling starts another one. */
export class WorkerError extends Error {}
