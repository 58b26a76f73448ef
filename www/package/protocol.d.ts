// Messages between the package and its worker.
import type { Bounds, FieldRequest, Parameter, Report } from '../src/engine/core-types.js';

type Settings = Record<string, number | string>;
/** What is asked; `of`: the request that has made the sample. */
export type Asked =
  | { type: 'sample'; id: number; field: SentField; settings: Settings; measure: boolean }
  | { type: 'moved'; id: number; of: number; field: SentField; settings: Settings; measure: boolean }
  | { type: 'mesh'; id: number; of: number }
  | { type: 'file'; id: number; of: number; format: string };
/** What is said besides: `stop` ends a request, `free` gives a sample up. */
export type Said = { type: 'stop'; id: number } | { type: 'free'; id: number };
export type SentField = Partial<FieldRequest> & { parameters: Record<string, number> };

export interface Made {
  positions: Float32Array | Float64Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
  parents: Uint32Array;
  report: Report | null;
  bounds: Bounds;
  parameters: Parameter[];
  digest: string;
}
export interface Answered {
  id: number;
  value?: object;
  error?: { name: string; message: string; facts: object };
  progress?: { phase: string; particles: number; fraction: number };
}
/** What a worker has around it. */
export interface Environment {
  post: (message: Answered, transfer?: ArrayBufferLike[]) => void;
  /** lets the worker hear its messages */
  pause: () => Promise<void>;
  /** loads the module of the core */
  load: () => Promise<unknown>;
}
/** The part of a worker that the client uses, in a browser and in Node. */
export interface Line {
  post: (message: Asked | Said) => void;
  end: () => void;
  /** whether the worker keeps the program alive */
  hold: (isHeld: boolean) => void;
}
export interface Heard {
  onMessage: (message: Answered) => void;
  /** the worker has not started, or has failed */
  onFail: (message: string) => void;
}
