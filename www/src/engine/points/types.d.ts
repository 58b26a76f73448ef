// Messages between the page and the worker that turns points into a field, and what its client is given. A worker
// handles one model or file and is then terminated, which releases the memory that a large file takes. Termination is
// also how an order is cancelled.
import type { Timers } from '../bundle/types.js';
import type { KeyedFile, Opened } from '../files/types.js';
import type { Store } from '../store.js';
import type { Bounds, ModelInfo, PointsAnswer, SampleKind, SolvedAnswer } from '../types.js';

export type WorkerLike = import('../bundle/types.js').WorkerLike<Order, FromPoints>;
export type Refusal = {
  kind: string;
  message: string;
  details?: string;
  action?: { label: string; run: () => void };
};
/**
 * A request for a built-in model, by its id, or for a file, of whose points so many are to be fitted; null for the
 * default number.
 */
export type Order = ({ model: string } | { file: File }) & { centres: number | null };
/** An order with the surface's id and its name on the page; none for an image that is computed. */
export type Wanted = { id: string; name: string; order: Order | null };
/** A solved model. The core reads `field` together with `info`; `centres` has three coordinates per centre. */
export type Solved = { field: Uint8Array; info: { info: ModelInfo; bounds: Bounds }; centres: Float32Array };
/** `failed`: the bundle did not load */
export type FromPoints =
  | { type: 'progress'; label: string; fraction: number }
  | { type: 'beat' }
  | { type: 'solved'; solved: Solved }
  | { type: 'refused'; kind: string; message: string }
  | { type: 'crashed'; message: string; stack: string }
  | { type: 'failed'; message: string };
/** The part of the bundle's class that the loop uses. */
export interface PointsLike {
  model: (id: string, centres: number) => PointsAnswer;
  file: (name: string, bytes: Uint8Array, centres: number) => PointsAnswer;
  step: (budget: number) => PointsAnswer;
  field: () => Uint8Array;
  info: () => SolvedAnswer;
  centres: () => Float32Array;
}
export interface PointsClientOptions {
  spawn: () => WorkerLike;
  onProgress: (progress: Extract<FromPoints, { type: 'progress' }>) => void;
  clock?: Timers;
}
export interface LoaderOptions {
  store: Store;
  spawn: () => WorkerLike;
  /** samples the present state */
  sample: (kind?: SampleKind) => void;
  /** opens the file of an image or a mesh in the sampler's worker */
  openGiven?: (file: KeyedFile, onProgress: (label: string, fraction: number) => void) => Promise<Opened>;
  stopOpening?: () => void;
}
