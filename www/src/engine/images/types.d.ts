// Files of images, on their way into the core.
import type { ImageFacts } from '../core-types.js';

/** A file, and those that lie beside it, one of which may hold its voxels. */
export type ImageFile = { name: string; file: Blob; beside: { name: string; file: Blob }[] };
/** An image of the page: a key stands for its file. */
export type KeyedImage = ImageFile & { key: string };
/** How opening a file ended; null if it was stopped. */
export type Opened = { ok: true; facts: ImageFacts } | { ok: false; message: string } | null;
export interface OpenEnv {
  /** says how far the work is, from 0 to 1 */
  tell: (label: string, fraction: number) => void;
  /** whether the work is to stop */
  isOver: () => boolean;
  /** memory that reading and filtering may take, as the header promises it */
  mostBytes: number;
}
