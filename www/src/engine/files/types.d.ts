// Files of images and triangle meshes, on their way into the core.
import type { FaultKind, ImageFacts } from '../core-types.js';

/**
 * A file, what it is opened as, and those that lie beside it, one of which may hold its voxels. Of an image, the first
 * of `step` voxels along each axis is kept.
 */
export type GivenFile = {
  as: 'image' | 'mesh';
  name: string;
  file: Blob;
  beside: { name: string; file: Blob }[];
  step?: number;
};
/** A file of the page: a key stands for it. */
export type KeyedFile = GivenFile & { key: string };
/**
 * How opening a file ended; null if it was stopped. There are facts of an image. A refusal is of the kind of the core's
 * fault, or of the kind of the file, with the `step` of an image that would fit into memory.
 */
export type Opened =
  | { ok: true; facts: ImageFacts | null }
  | { ok: false; kind: Refused['kind']; message: string; step?: number }
  | null;
/** Why a file is not opened. */
export type Refused = { kind: FaultKind; message: string };
export interface OpenEnv {
  /** says how far the work is, from 0 to 1 */
  tell: (label: string, fraction: number) => void;
  /** whether the work is to stop */
  isOver: () => boolean;
  /** memory that reading and filtering may take, as the header promises it */
  mostBytes: number;
  nowMs: () => number;
  /** ends the task of the worker, so that its messages are handled */
  pause: () => Promise<void>;
}
/** The part of its surroundings that making a field uses: `tell` says how far it is, from 0 to 1. */
export type MakeEnv = Pick<OpenEnv, 'nowMs' | 'pause'> & { tell: (fraction: number) => void };
