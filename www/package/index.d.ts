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
  /** share of the work that is done, including the report */
  fraction: number;
}
/** A share of the diagonal of the box, such as '1%'. */
export type Share = `${number}%`;
/** A length in the units of the field, or a share of the diagonal of the box. */
export type Size = number | Share;
/**
 * Options of a sampling. One of `count`, `spacing` and `radius` sets the size; the default radius is 0.6 % of the
 * diagonal, and adaptive particles stay close to the surface.
 */
export interface Options {
  /** number of particles, met within 3 %: 1 to 4,000,000 */
  count?: number;
  /**
   * distance between neighbours, two radii: a length, or a share of the diagonal such as '1%'. A formula of x, y, z or
   * a function makes it depend on the place; with a count it gives the proportions
   */
  spacing?: number | string | OfPlace;
  /** half of the distance between neighbours */
  radius?: Size;
  /** the box to sample; by default one that fits the surface */
  bounds?: Bounds;
  /** of points: whether their surface ends at their border (default) or continues */
  beyondPoints?: 'cut' | 'kept';
  /**
   * of points, an image, a mesh or a union: a formula in which `model` is their surface, as an operand of max, min,
   * smin, smax or abs, or with a number added: `max(model, z)` cuts it
   */
  formula?: string;
  /** values of the names in the formula; others are 1, or those of the surface of the gallery */
  params?: Record<string, number>;
  /**
   * of an image: the value of the voxels on the surface; by default Otsu's, which best separates dark from bright
   * voxels
   */
  iso?: number;
  /** of an image: a whole number whose voxels are inside, instead of `iso` */
  label?: number;
  /**
   * of an image: width of a Gaussian in voxels, 0 for none. The default is 0 or 0.7 to 2, by the measured noise and the
   * rounding of whole numbers; for a label it is the root mean square of the distances between voxels, 1 for cubes, over
   * the distances. Of a mesh: treats it as a scan, and is the width in cells of its grid, up to 10
   */
  smooth?: number;
  /** of an image: whether the darker voxels are inside */
  darkInside?: boolean;
  /** of an image: whether a surface that its border cuts is closed there; otherwise it ends with a rim */
  closeBorder?: boolean;
  /**
   * of a mesh: the angle in degrees above which an edge stays sharp; `auto`, the default, is 30° if such edges form
   * curves, unless holes are closed; `none` rounds all edges
   */
  edges?: number | 'auto' | 'none';
  /**
   * of a mesh: whether the surface ends at its borders, or holes are closed; by default it ends there if the mesh is an
   * open surface, such as a leaf or a terrain
   */
  borders?: boolean;
  /** whether particles are smaller where the surface is more curved */
  adaptive?: boolean;
  /** how the radius follows from the curvature; default `chord_error` */
  law?: 'chord_error' | 'max_curvature' | 'sum_of_curvatures';
  /** largest gap between the surface and a triangle of neighbours; default '0.0045%' */
  chordError?: Size;
  /** radius of a particle over the radius of curvature of the surface there, for the other two laws; default 0.015 */
  curvatureScale?: number;
  /** radius of the smallest particles, at least; default '0.1%' */
  radiusMin?: Size;
  /** radius of the largest particles, at most; default '3%' */
  radiusMax?: Size;
  /** how fast the radius may change along the surface: a slope without unit, 0.01 to 0.5; default 0.2 */
  grading?: number;
  /** of a formula: whether the faces of the box close the surface, giving the solid f <= 0 in the box */
  closed?: boolean;
  /** whether opposite faces of a closed box have the same particles */
  periodic?: boolean;
  /**
   * of a formula: thickness of a shell around the surface, which is sampled instead; a number or a formula
   */
  thickness?: number | string;
  /** `refined` takes longer and spaces particles more evenly */
  method?: 'front' | 'refined';
  /**
   * `blue`: blue noise, no pair nearer than two radii and no hole wider; `random`: independent points, even by area.
   * They are not relaxed, and have exactly the wanted `count`
   */
  pattern?: 'hexagonal' | 'blue' | 'random';
  /** whether a front gets exactly the wanted `count`, and not only to within 3 % */
  exactly?: boolean;
  /** relaxation steps after the front; default 10 */
  relax?: number;
  /** distance, in units of two radii, within which a child is matched with a particle: 0.5 to 0.9; default 0.7 */
  matchTolerance?: number;
  /** whether gaps between fronts are filled with a particle; default `fill` */
  gaps?: 'fill' | 'leave';
  /** a whole number that chooses the point where the front begins; default 0 */
  seed?: number;
  /** number of particles at which the run stops; default 4,400,000 */
  maxParticles?: number;
  /**
   * values at the particles, by name: formulas of x, y, z, the normal (n_x, n_y, n_z), the principal curvatures (k_1,
   * k_2), the direction of k_1 (d_x, d_y, d_z), radius, level, area and edge, the distance to the nearest sharp edge
   * or rim; or functions of a point. Files contain them, too
   */
  values?: Record<string, string | OfPlace>;
  /** whether to make a report, which takes about as long as the sampling; default true */
  measure?: boolean;
  /** ends the sampling, whose promise rejects with the signal's reason */
  signal?: AbortSignal;
  onProgress?: (progress: Progress) => void;
}
export type { ImageInfo, MeshChange, MeshInfo, Report };
export type Warning = Report['warnings'][number];
export interface Mesh {
  /**
   * three rows of `points` for each triangle, counter-clockwise seen from outside. Shaded with `normals` they show
   * sharp edges as sharp
   */
  faces: Uint32Array;
  /** the volume of a closed mesh; null if it is open */
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
   * three values for each row of the columns, in double precision if the box is far from the origin. A particle has one
   * row, or one on each side of a crease or a smooth join
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
  /** values of the names in the formula; for an image the chosen `iso` and `smooth`, for a mesh `edges` or `smooth` */
  readonly params: Record<string, number>;
  /** values at the rows of the columns, by the names in the option `values` */
  readonly values: Record<string, Float32Array>;
  /** of an image: its properties, and what was chosen */
  readonly image: ImageInfo | null;
  /** of a mesh: its properties, its repairs, and how it was treated */
  readonly original: MeshInfo | null;
  /**
   * of a mesh without a formula: its distance from the new mesh, with volume and area before and after; null with
   * `measure: false`
   */
  readonly change: MeshChange | null;
  readonly digest: string;
  /**
   * joins the particles to triangles. With `weld` the rows of a particle at a crease or a smooth join become one, with
   * the normal of one side
   */
  mesh(how?: { weld?: boolean }): Promise<Mesh>;
  /**
   * a file: the mesh as `glb`, `3mf`, `stl` or `obj`, the particles as `ply`, `csv`, `npy` or `xyz`;
   * with `mesh` a `ply` of the mesh. The file of a formula records how it was made
   */
  toFile(format: Format, how?: { mesh?: boolean }): Promise<Uint8Array<ArrayBuffer>>;
  /**
   * saves what `toFile` gives, in the format that the ending of the path names: in Node as a file,
   * in a page as a download. How a CSV file of a formula was made is recorded in a second file, which has the name of
   * the first one and `.json`
   */
  save(path: string, how?: { mesh?: boolean }): Promise<void>;
  /**
   * the particles on the surface of other parameters, or of another `iso` of an image. They leave this sample, whose
   * columns stay. They are lost if there is no such surface or the signal ends the move
   */
  moved(params: Record<string, number>, options?: Pick<Options, 'signal' | 'onProgress'>): Promise<Sample>;
  /**
   * frees the worker's memory once the requested meshes and files are made; the columns stay
   */
  dispose(): void;
  [Symbol.dispose](): void;
}

/** A function of a point. */
export type OfPlace = (x: number, y: number, z: number) => number;
/** A function of many points at once. */
export interface Batch {
  /** writes f at each point to `out`; `xyz` has three coordinates for each of its values */
  batch(xyz: Float64Array, out: Float64Array): void;
}
/**
 * A function composed of smooth ones, the pieces; `label` gives the index of the piece at a point. The surface has an
 * edge where the piece changes. A piece is also called a few particles beyond its own region.
 */
export interface Pieces {
  label(x: number, y: number, z: number): number | boolean;
  pieces: OfPlace[];
}
/** Points of a surface, three coordinates each, and their outward normals if known. */
export interface Points {
  points: Numbers;
  normals?: Numbers;
}
/** A file of points or of a mesh, whose vertices they are: PLY, OBJ, STL, OFF, GLB, 3MF, PCD, XYZ, PTS or CSV. */
export interface PointsFile {
  points: Blob | ArrayBuffer | Uint8Array;
  name?: string;
}
/** x, y and z of each point, one after the other or in rows of three. */
export type Numbers = Float32Array | Float64Array | Int32Array | number[] | [number, number, number][];
/** A file of an image: NIfTI, NRRD, NPY, MetaImage, Gaussian cube or TIFF; its content decides. */
export interface ImageFile {
  image: Blob | ArrayBuffer | Uint8Array;
  /** name of the file, from which the name of a NIfTI header's `.img` file follows */
  name?: string;
  /** other files, one of which holds the voxels of a header */
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
  /** distances between neighbours along each axis, or one for all; default 1 */
  spacing?: number | [number, number, number];
  /** the position of voxel (0, 0, 0); default the origin */
  origin?: [number, number, number];
  /** the rows of a matrix that maps (i, j, k, 1) to a point, instead of spacing and origin */
  affine?: number[][];
  name?: string;
}
/**
 * A triangle mesh to sample again: a file (STL, OBJ, PLY, OFF, GLB or 3MF; its content decides), or arrays of three
 * coordinates for each vertex and three vertices for each face.
 */
export interface MeshSource {
  mesh:
    | Blob
    | ArrayBuffer
    | Uint8Array
    | { points: Numbers; faces: Uint32Array | number[] | [number, number, number][] };
  name?: string;
}
/** A solid that is made of others by `union` and the like. */
export interface Solid {
  readonly join: 'union' | 'intersection' | 'difference' | 'smoothUnion' | 'offset';
  readonly of: readonly Field[];
  /** the width of a smooth union, the distance of an offset */
  readonly by?: number;
}
/**
 * What can be sampled: a formula such as `x^2 + y^2 + z^2 = a`, or the name of a surface of the gallery such as
 * `torus`; a function f(x, y, z) of one point or of many at once, negative inside and NaN where undefined; the pieces
 * of such a function; points; a three-dimensional image; a triangle mesh; or a solid that is made of such fields.
 */
export type Field =
  | string
  | OfPlace
  | Batch
  | Pieces
  | Points
  | PointsFile
  | ImageFile
  | ImageArray
  | MeshSource
  | Solid;

/**
 * The union of solids, or of a list of them: min(a, b, …), negative where one of them is. Where their surfaces meet at
 * an angle, particles lie on the edge and the mesh is closed along it. Edges are searched for in cells of a 128th of
 * the box: a smaller loop may be missed. Formulas are better written as one with `min`, `max` and `-`, which proves
 * that nothing is missing. `params` has the values for all formulas.
 */
export function union(...solids: Field[] | [readonly Field[]]): Solid;
/** The intersection of solids, or of a list of them: max(a, b, …), negative where all are. */
export function intersection(...solids: Field[] | [readonly Field[]]): Solid;
/** The difference of two solids: max(a, −b), negative where a is and b is not. */
export function difference(a: Field, b: Field): Solid;
/** The union of two solids, rounded where the fields differ by less than the width: `smin(a, b, width)` of formulas. */
export function smoothUnion(a: Field, b: Field, width: number): Solid;
/** The field a − distance: if a is the distance from a solid, this solid is larger by `distance`. */
export function offset(a: Field, distance: number): Solid;

/**
 * Covers the surface f = 0 with evenly spaced particles. Formulas, points, images and meshes are sampled in a worker. A
 * function is called in its own thread, in slices of some milliseconds between which the page can draw.
 */
export function sample(field: Field, options?: Options): Promise<Sample>;

/** An argument or an option is not valid. */
export class InputError extends Error {}
/** The formula is wrong between `start` and `end`, in UTF-16 code units. */
export class FormulaError extends Error {
  readonly start: number;
  readonly end: number;
  /**
   * a text for that place, if one would correct it; `choices` holds several with different meanings
   */
  readonly suggestion: string | null;
  readonly choices: string[];
}
/**
 * The sampled function threw the `cause`, or did not return its values.
 */
export class FieldError extends Error {}
/** No particle could be placed. */
export class NoSurfaceError extends Error {}
/** The sample was disposed of, or its particles have moved to another sample. */
export class DisposedError extends Error {}
/** The worker did not start, or failed. The next sampling starts a new one. */
export class WorkerError extends Error {}
