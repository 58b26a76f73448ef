/**
 * Reads the file of an image and opens it in the core. What the header promises is known, and its memory is held to a
 * limit, before the rest is read. For the sampler's worker and for the package.
 *
 * @module
 */
import { words } from '../bundle/load.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { ImageFacts, ImagePromise } from '../core-types.js'
 * @import { ImageFile, OpenEnv } from './types.js'
 */

/** Of a file so much is enough for its header. */
const START_BYTES = 1 << 20;
/** Share of the work that is done once the file is read. The rest is the core's. */
const READ_SHARE = 0.7;

/** Ends the reading with a message for the user. */
class Refused extends Error {}

const megabytes = (/** @type {number} */ bytes) => Math.max(1, Math.round(bytes / 1e6)).toLocaleString('en');

/**
 * Says what the header of a file promises.
 * @param {ImagePromise} promise
 */
function promised({ size, voxel_type, memory }) {
  if (!size) return 'Reading';
  return `Reading ${size.join(' × ')} voxels of ${voxel_type}, about ${megabytes(memory)} MB of memory`;
}

/**
 * Reads a file to its end, or returns null if that is to stop.
 * @param {Blob} file @param {(share: number) => void} tell @param {() => boolean} isOver
 */
async function bytesOf(file, tell, isOver) {
  const bytes = new Uint8Array(file.size);
  const reader = file.stream().getReader();
  for (let at = 0; ; ) {
    const { done, value } = await reader.read();
    if (isOver()) {
      void reader.cancel();
      return null;
    }
    if (done) return bytes.subarray(0, at);
    bytes.set(value, at);
    at += value.length;
    tell(at / file.size);
  }
}

/**
 * Opens a file in the core, whose image it is then. Returns null if that was to stop.
 * @param {Core} core @param {ImageFile} image @param {OpenEnv} env
 * @returns {Promise<{ok: true, facts: ImageFacts} | {ok: false, message: string} | null>}
 */
export async function openImage(core, { name, file, beside }, env) {
  try {
    return await opened(core, { name, file, beside }, env);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) throw error;
    const why = error instanceof Refused ? error.message : `the file cannot be read: ${words(error)}`;
    return { ok: false, message: why };
  }
}

/** @param {Core} core @param {ImageFile} image @param {OpenEnv} env */
async function opened(core, { name, file, beside }, { tell, isOver, mostBytes }) {
  tell('Reading', 0);
  const start = new Uint8Array(await file.slice(0, START_BYTES).arrayBuffer());
  const promise = core.image_promise(name, start);
  if (!promise.ok) throw new Refused(promise.error.message);
  if (promise.memory > mostBytes)
    throw new Refused(
      `the image of ${promise.size?.join(' × ')} voxels takes about ${megabytes(promise.memory)} MB of memory, and ` +
        `there are ${megabytes(mostBytes)} MB here; cut out the part that matters, or keep every second voxel`,
    );
  const label = promised(promise);
  tell(label, 0);
  /** @type {Map<string, Uint8Array>} */
  const others = new Map();
  for (const other of beside) {
    if (isOver()) return null;
    others.set(other.name, new Uint8Array(await other.file.arrayBuffer()));
  }
  const bytes = await bytesOf(file, (share) => tell(label, READ_SHARE * share), isOver);
  if (!bytes) return null;
  const answer = core.open_image(name, bytes, (wanted) => others.get(wanted));
  if (!answer.ok) throw new Refused(answer.error.message);
  const { ok: _, ...facts } = answer;
  return /** @type {const} */ ({ ok: true, facts });
}
