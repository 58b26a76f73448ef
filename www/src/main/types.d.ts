// Types of the console.
import type { Columns, Engine, EngineOptions, Figures, Report, State } from '../engine/types.js';

export interface Console {
  /** of the core; empty until the core has loaded */
  version: string;
  /** resolves once the first run is done and on screen */
  ready: Promise<Report | null>;
  state: State;
  /** changes the state, samples, and resolves with the report */
  set: (patch: object) => Promise<Report | null>;
  run: () => Promise<Report | null>;
  stop: () => Promise<Report | null>;
  /** samples the points of a file */
  open: (file: File) => Promise<Report | null>;
  relax: (steps?: number) => Promise<Report | null>;
  report: () => Report | null;
  particles: () => Particles;
  status: () => object;
  pixels: (
    width: number,
    height: number,
    transparent?: boolean,
  ) => Promise<{ width: number; height: number; pixels: Uint8Array }>;
  /** the address that restores the present state */
  link: () => Promise<string>;
  /** another engine, in another element */
  create: (options: EngineOptions) => Engine;
  engine: Engine;
  debug: Omit<Engine['debug'], 'isOff'>;
}
/**
 * Copies of the columns: index i of each belongs to particle i. `exact`: the positions in double precision, in a box
 * far from the origin; `curvature`: two per particle, only while they are shown.
 */
export type Particles = Measured &
  Pick<Columns, 'count' | 'positions' | 'normals' | 'radii' | 'levels' | 'parents' | 'slots'> & {
    exact: Float64Array | null;
    curvature: Float32Array | null;
  };
/** The columns of the report, null before it has arrived. */
export type Measured = { [K in keyof Figures]: Figures[K] | null };
/** A message of a page that has this one in a frame. `id` comes back with the answer. */
export interface Request {
  call: 'set' | 'get' | 'report';
  id?: unknown;
  value?: unknown;
}
