// What the package `marching-particles` gives a program.
/// <reference lib="esnext.disposable" />
import type { ImageInfo, MeshChange, MeshInfo, Report } from '../src/engine/core-types.js';

export interface Bounds {
  min: [number, number, number];
  max: [number, number, number];
}
export interface Progress {
  /**
   * `reading` of a file, `seeding`, `generation`, `search`, `relaxation`, `refinement`, and `measuring` for the report
   */
  phase: string;
  particles: number;
  /** share of the work that is done, that of the report included */
  fraction: number;
}
/** A length in the units of the field, or a share of the diagonal of the box such as '1%'. */
export type Size = number | `${number}%`;
/**
 * What a surface is sampled with. One of `count`, `spacing` and `radius` gives the size; without it
 * the radius is 0.6 % of the diagonal, and adaptive particles keep close to the surface.
 */
export interface Options {
  /** number of particles, met within 3 %: 1 to 4,000,000 */
  count?: number;
  /**
   * distance between neighbours, two radii: a length, or a share of the diagonal such as '1%'; by a
   * formula of x, y, z or a function it depends on the place. Beside a count it gives the proportions
   */
  spacing?: number | string | OfPlace;
  /** half of the distance between neighbours */
  radius?: Size;
  /** the box that is sampled; without it one that fits the surface */
  bounds?: Bounds;
  /** of points: whether their surface ends at their border, as it does without it, or goes on */
  beyondPoints?: 'cut' | 'kept';
  /**
   * of points, an image or a mesh: a formula that names their surface `model`, as an operand of max, min,
   * smin, smax or abs, or with a number that is added: `max(model, z)` cuts it
   */
  formula?: string;
  /** values of the names in the formula */
  params?: Record<string, number>;
  /**
   * of an image: the value of the voxels on the surface; without it Otsu's, which separates dark
   * from bright ones best
   */
  iso?: number;
  /** of an image: a whole number whose voxels are inside, in place of `iso` */
  label?: number;
  /**
   * of an image: width of a Gaussian in voxels, 0 for none. Without it from 0.7 to 2 or 0, by the
   * noise that is measured and the rounding of whole numbers; over the distances from a label 1. Of
   * a mesh: that in cells of the grid of a scan, up to 10, for which the mesh is taken then
   */
  smooth?: number;
  /** of an image: whether the darker voxels are inside */
  darkInside?: boolean;
  /**
   * of a mesh: the angle in degrees from which on an edge stays sharp; `auto`, which is chosen
   * without it, keeps those of 30° if they form curves on a closed mesh, `none` rounds all
   */
  edges?: number | 'auto' | 'none';
  /** whether particles are small where the surface bends and large where it is flat */
  adaptive?: boolean;
  /** how the radius follows from the curvature; `chord_error` without it */
  law?: 'chord_error' | 'max_curvature' | 'sum_of_curvatures';
  /** largest gap between the surface and a triangle of neighbours */
  chordError?: Size;
  /** radius of a particle over the radius of curvature under it, for the other two laws */
  curvatureScale?: number;
  radiusMin?: Size;
  radiusMax?: Size;
  /** slope of the radius along the surface */
  grading?: number;
  /** of a formula: whether the faces of the box close what they cut, the solid f <= 0 in the box */
  closed?: boolean;
  /** whether opposite faces of a closed box have the same particles */
  periodic?: boolean;
  /**
   * of a formula: thickness of a sheet around the surface that is sampled in its place, a number or
   * a formula
   */
  thickness?: number | string;
  /** `refined` takes longer and is more even */
  method?: 'front' | 'refined';
  /** steps of relaxation after the front; 10 without it */
  relax?: number;
  /** distance over two radii within which a child joins a particle that is there, 0.5 to 0.9 */
  matchTolerance?: number;
  /** whether gaps where fronts meet get a particle; `fill` without it */
  gaps?: 'fill' | 'leave';
  seed?: number;
  /** number of particles at which the run stops */
  maxParticles?: number;
  /**
   * numbers at the particles, by name: formulas of x, y, z and of the normal (n_x, n_y, n_z), the
   * principal curvatures (k_1, k_2), a direction of k_1 (d_x, d_y, d_z), radius, level, area and edge,
   * the distance to the nearest sharp edge; or
   * functions of place. Files have them as well
   */
  values?: Record<string, string | OfPlace>;
  /** whether a report is made, which takes about as long as the sampling; true without it */
  measure?: boolean;
  /** ends the sampling, whose promise is rejected with the signal's reason */
  signal?: AbortSignal;
  onProgress?: (progress: Progress) => void;
}
export type { ImageInfo, MeshChange, MeshInfo, Report };
export type Warning = Report['warnings'][number];
export interface Mesh {
  /**
   * three rows of `points` for each triangle, counter-clockwise seen from outside. With `points` and
   * `normals` they shade sharp edges sharply
   */
  faces: Uint32Array;
  /** what a closed mesh encloses; null where it is open */
  volume: number | null;
  components: { triangles: number; euler: number; open_edges: number }[];
  /** number of particles in no triangle */
  leftOut: number;
}
/** Files of the mesh; `ply` can be of the particles, too. */
export type MeshFormat = 'glb' | '3mf' | 'stl' | 'obj' | 'ply';
/** Files of the mesh, and of the particles. */
export type Format = MeshFormat | 'csv' | 'npy' | 'xyz';

export interface Sample {
  /** number of particles */
  readonly count: number;
  /**
   * three values for each row of the columns; in double precision where the box is far from the
   * origin. A particle has one row, or one on each side of a crease or a seam
   */
  readonly points: Float32Array | Float64Array;
  readonly normals: Float32Array;
  readonly radii: Float32Array;
  /** generation levels, and the row of the parent, 0xffffffff for a seed */
  readonly levels: Uint32Array;
  readonly parents: Uint32Array;
  /** null with `measure: false` */
  readonly report: Report | null;
  readonly warnings: Warning[];
  readonly bounds: Bounds;
  /** values of the names in the formula; of an image `iso` and `smooth`, of a mesh
   * `edges` or `smooth`, as they were chosen */
  readonly params: Record<string, number>;
  /** numbers at the rows of the columns, by the names of the option `values` */
  readonly values: Record<string, Float32Array>;
  /** of an image: what is known of it, and what was chosen */
  readonly image: ImageInfo | null;
  /** of a mesh: what it had, what was mended, and what it was taken for */
  readonly original: MeshInfo | null;
  /**
   * of a mesh by itself: how far the new one is from it, with volume and area before and after;
   * null with `measure: false`
   */
  readonly change: MeshChange | null;
  readonly digest: string;
  /**
   * joins the particles to triangles; with `weld` those at a crease or a seam share a row, and have
   * the normal of one side
   */
  mesh(how?: { weld?: boolean }): Promise<Mesh>;
  /**
   * a file: the mesh as `glb`, `3mf`, `stl` or `obj`, the particles as `ply`, `csv`, `npy` or `xyz`;
   * with `mesh` a `ply` of the mesh. A file of a formula says what it was made from
   */
  toFile(format: Format, how?: { mesh?: boolean }): Promise<Uint8Array<ArrayBuffer>>;
  /**
   * saves what `toFile` gives, in the format that the ending of the path names: in Node as a file,
   * in a page as a download. What a CSV file of a formula was made from goes into a file beside it,
   * whose name goes on with `.json`
   */
  save(path: string, how?: { mesh?: boolean }): Promise<void>;
  /**
   * the particles on the surface of other parameters, or of another
   * `iso` of an image; they leave
   * this sample, whose columns stay,
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

/** A function of a point. */
export type OfPlace = (x: number, y: number, z: number) => number;
/** A function of many points at once. */
export interface Batch {
  /** writes f at each point to `out`; `xyz` has three numbers for each of its values */
  batch(xyz: Float64Array, out: Float64Array): void;
}
/**
 * A function put together of smooth ones, the pieces, by one that gives the index of the piece at a
 * point. The surface has an edge where it passes from one piece to another. A piece is called also
 * a few particles beyond its part.
 */
export interface Pieces {
  label(x: number, y: number, z: number): number | boolean;
  pieces: OfPlace[];
}
/** Points of a surface, three numbers each, and their outward normals if they are known. */
export interface Points {
  points: Numbers;
  normals?: Numbers;
}
/** A file of points or of a mesh, whose vertices they are: PLY, OBJ, STL, OFF, PCD, XYZ, PTS or CSV. */
export interface PointsFile {
  points: Blob | ArrayBuffer | Uint8Array;
  name?: string;
}
/** x, y and z of each point, one after the other or in rows of three. */
export type Numbers = Float32Array | Float64Array | Int32Array | number[] | [number, number, number][];
/** A file of an image: NIfTI, NRRD, NPY, MetaImage, Gaussian cube or TIFF, whichever its content says. */
export interface ImageFile {
  image: Blob | ArrayBuffer | Uint8Array;
  /** name of the file, by which a `.img` beside a NIfTI header is found */
  name?: string;
  /** files beside it, one of which holds the voxels of a header */
  beside?: File | File[];
}
/** Voxels of an array: voxel (i, j, k) is `image[i + size[0] * (j + size[1] * k)]`. */
export interface ImageArray {
  image:
    | Uint8Array
    | Uint8ClampedArray
    | Int8Array
    | Uint16Array
    | Int16Array
    | Uint32Array
    | Int32Array
    | BigUint64Array
    | BigInt64Array
    | Float32Array
    | Float64Array;
  size: [number, number, number];
  /** distances between neighbours along each axis, or one for all; 1 without it */
  spacing?: number | [number, number, number];
  /** the point of voxel (0, 0, 0); the origin without it */
  origin?: [number, number, number];
  /** the rows of a matrix that maps (i, j, k, 1) to a point, in place of spacing and origin */
  affine?: number[][];
  name?: string;
}
/**
 * A triangle mesh, which is sampled anew: a file (STL, OBJ, PLY, OFF or GLB, whichever its content
 * says), or arrays of three coordinates for each vertex and three vertices for each face.
 */
export interface MeshSource {
  mesh:
    | Blob
    | ArrayBuffer
    | Uint8Array
    | { points: Numbers; faces: Uint32Array | number[] | [number, number, number][] };
  name?: string;
}
/**
 * What is sampled: a formula such as `x^2 + y^2 + z^2 = a`; a function f(x, y, z), negative inside
 * and NaN where it has no value, of a point or of many at once; the pieces of such a function;
 * points; a three-dimensional image; or a triangle mesh.
 */
export type Field = string | OfPlace | Batch | Pieces | Points | PointsFile | ImageFile | ImageArray | MeshSource;

/**
 * Covers the surface f = 0 with evenly spaced particles. Formulas, points, images and meshes are
 * sampled in a worker; a function is called in the thread that it belongs to, in slices of some milliseconds
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
