// Messages between the program and the sampler, which is in a worker or in the program's own thread.
import type {
  Bounds,
  FieldRequest,
  ImageInfo,
  MeshChange,
  MeshInfo,
  Parameter,
  Report,
} from '../src/engine/core-types.js';
import type { GivenFile } from '../src/engine/files/types.js';
import type { Batch, OfPlace, Pieces, Progress, Solid } from './index.js';

/** Settings of the core by their names there; `lengths` replace shares. */
export type Settings = Record<string, number | string | Record<string, number>>;
/** Requests. `of` is the request that made the sample. */
export type Asked =
  | {
      type: 'sample';
      id: number;
      field: SentField;
      functions: SentFunctions;
      settings: Settings;
      given: Record<string, string>;
      measure: boolean;
    }
  | {
      type: 'moved';
      id: number;
      of: number;
      field: SentField;
      functions: SentFunctions;
      settings: Settings;
      measure: boolean;
    }
  | { type: 'mesh'; id: number; of: number; weld: boolean }
  | { type: 'file'; id: number; of: number; format: string; mesh: boolean };
/** Other messages: `stop` ends a request, `free` gives up a sample. */
export type Said = { type: 'stop'; id: number } | { type: 'free'; id: number };
/** A formula, points, an image, a mesh, a combination, or a function of the program, which never leaves its thread. */
export interface SentPart {
  formula?: string;
  cloud?: Cloud;
  given?: GivenFile | SentVoxels | SentFaces;
  program?: OfPlace | Batch | Pieces;
  solid?: { join: Solid['join']; of: SentPart[]; by: number };
}
/** Such a field with its parameters. Beside another one a formula has the other's surface as an operand. */
export type SentField = SentPart & Pick<FieldRequest, 'parameters'> & Pick<Partial<FieldRequest>, 'bounds'>;
/** Functions of a point; those of the program never leave its own thread. */
export interface SentFunctions {
  spacing?: string | OfPlace;
  values: Record<string, string | OfPlace>;
}
/** The bytes of a voxel array in a type of the core, and its affine map, row by row. */
export type SentVoxels = { name: string; type: string; size: number[]; rows: number[]; voxels: Uint8Array };
/** The coordinates of vertices and the vertex indices of faces, three each. */
export type SentFaces = { name: string; points: Float64Array; faces: Uint32Array };
/** Points, and their normals if they are known, three numbers each; or a file of them. */
export type Cloud = { points: Float64Array; normals: Float64Array | null } | { name: string; file: Blob };

export interface Made {
  /** number of particles */
  count: number;
  points: Float32Array | Float64Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
  parents: Uint32Array;
  report: Report | null;
  bounds: Bounds;
  parameters: Parameter[];
  values: Record<string, Float32Array>;
  image: ImageInfo | null;
  original: MeshInfo | null;
  change: MeshChange | null;
  digest: string;
}
export interface Answered {
  id: number;
  value?: object;
  error?: { name: string; message: string; facts: object };
  progress?: Progress;
}
/** Returns where a module of the core is, or its bytes. */
export type Load = (name: 'core' | 'points') => Promise<URL | Uint8Array>;
/** What a sampler needs from its surroundings. */
export interface Environment {
  post: (message: Answered, transfer?: ArrayBufferLike[]) => void;
  load: Load;
}
/** The part of a worker, or of a sampler in the same thread, that the client uses. */
export interface Line {
  post: (message: Asked | Said) => void;
  end: () => void;
  /** whether the worker keeps the program alive */
  hold: (isHeld: boolean) => void;
}
export interface Heard {
  onMessage: (message: Answered) => void;
  /** the worker did not start, or failed */
  onFail: (message: string) => void;
}
