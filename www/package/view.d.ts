import type { Bounds, MeshFormat, Options, Progress, Report, Share, Size } from './index.js';

export { DisposedError, FormulaError, InputError, NoSurfaceError, WorkerError } from './index.js';

type InView<Value> = [Size] extends [Value] ? ([Value] extends [Size] ? Share : Value) : Value;
/** The options of `sample` that a view has: `null` stands for the default. Sizes are shares of the box diagonal. */
type Sampled = {
  [Name in keyof Omit<
    Options,
    | 'bounds'
    | 'formula'
    | 'params'
    | 'values'
    | 'iso'
    | 'label'
    | 'smooth'
    | 'darkInside'
    | 'edges'
    | 'measure'
    | 'signal'
    | 'onProgress'
    | 'spacing'
  >]?: InView<Exclude<Options[Name], undefined>> | null;
};
/**
 * What is sampled and how it is drawn, in the words of `sample`: `{formula, params: {a: 1}, count: 5000}`. Missing
 * entries stay as they are.
 */
export interface ViewState extends Sampled {
  /** a surface of the gallery, such as `gyroid`, or a model from points; null for the default */
  surface?: string | null;
  formula?: string;
  /** values of the names in the formula */
  params?: Record<string, number>;
  /** distance between neighbours: a share of the box diagonal, or a formula */
  spacing?: string | null;
  /** null: a box that fits the surface */
  bounds?: Bounds | null;
  /** hides points with normal · p > offset */
  plane?: { normal: [number, number, number]; offset: number } | null;
  view?: {
    colour?: string;
    draw?: 'discs' | 'spheres' | 'mesh';
    theme?: 'auto' | 'light' | 'dark';
    [option: string]: unknown;
  };
}
/** What draws a picture. */
export type BackendKind = 'webgpu' | 'webgl2' | 'canvas2d';
export interface ViewOptions {
  /** the back end to try first; by default the best that draws quickly on this machine */
  backend?: BackendKind;
}
export interface Listeners {
  progress: (progress: Progress) => void;
  report: (report: Report) => void;
  error: (error: Error) => void;
}
/** Columns with a row per particle, or one on each side of a crease or a smooth join. */
export interface Particles {
  points: Float32Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
}
export interface View {
  /**
   * the report on the first surface, once its picture is complete; rejects like `set`, but invalid entries have their
   * defaults
   */
  readonly ready: Promise<Report | null>;
  /** a copy of the state, in the words of `sample`; of the options, only those that differ from their defaults */
  readonly state: ViewState;
  /** the last report; null while particles are being placed */
  readonly report: Report | null;
  /** what draws the picture; null before it is known */
  readonly backend: BackendKind | null;
  /**
   * changes a part of the state; rejects with the error of a formula, if there is no surface, or, changing nothing,
   * with an `InputError` that names an invalid entry
   */
  set(patch: ViewState): Promise<Report | null>;
  /** moves a slider: particles follow the surface while it is `live`; call once more without it at the end */
  setParameter(name: string, value: number, how?: { live?: boolean }): void;
  run(): Promise<Report | null>;
  stop(): Promise<Report | null>;
  /** copies of the columns */
  particles(): Particles;
  /** calls a function at each event; returns a function that ends this */
  on<Name extends keyof Listeners>(name: Name, listener: Listeners[Name]): () => void;
  /** fits the camera to the surface */
  fit(): void;
  lookFrom(side: 'front' | 'right' | 'top' | 'isometric'): void;
  /** a PNG; by default with the picture's own size in pixels */
  picture(size?: { width?: number; height?: number; transparent?: boolean }): Promise<Blob>;
  /** the mesh of the particles as a file */
  toFile(format: MeshFormat): Promise<Uint8Array<ArrayBuffer>>;
  /** the state as the fragment of a link to the page */
  link(): Promise<string>;
  /** frees the workers, the graphics device and the canvas; rejects pending promises with a `DisposedError` */
  destroy(): void;
}

/** Draws a surface in an element, which it fills, and samples it in a worker. */
export function createView(host: HTMLElement, state?: ViewState, options?: ViewOptions): View;
