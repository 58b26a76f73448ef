/**
 * Reads the file of an image or a triangle mesh and opens it in the core, for the sampler's worker and for the package.
 * The header of an image is read first, and its memory is checked against a limit before the rest is read.
 *
 * @module
 */
import { words } from '../bundle/load.js';
import { inSlices } from '../bundle/slices.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FaultKind, ImageFacts, ImagePromise } from '../core-types.js'
 * @import { GivenFile, Opened, OpenEnv } from './types.js'
 */

/** This much of a file is enough for its header. */
const START_BYTES = 1 << 20;
/** Share of the work that reading takes. The core does the rest. */
const READ_SHARE = 0.5;
/** First budget of the core's work, in slices of some ten microseconds. */
export const FIRST_SLICES = 64;
/**
 * Memory to read, repair and sample a mesh, divided by the size of its file: a triangle has 50 bytes in a binary STL
 * file and about 600 in the core's trees and tables.
 */
const MESH_FACTOR = 15;

/** Ends the reading with a message for the user. */
class Refusal extends Error {
  /** @param {FaultKind} kind @param {string} message @param {number} [step]  with which it can be opened */
  constructor(kind, message, step) {
    super(message);
    this.kind = kind;
    this.step = step;
  }
}

const megabytes = (/** @type {number} */ bytes) => Math.max(1, Math.round(bytes / 1e6)).toLocaleString('en');

/** Steps from voxel to voxel that are offered for an image that does not fit into memory. */
const STEPS = [2, 3, 4];

/**
 * The memory of an image of which every so-manieth voxel is kept: all voxels are read, and the others filtered.
 * @param {number} step @param {ImagePromise} promise
 */
function memoryWith(step, { size, memory, bytes }) {
  return step === 1 || !size ? memory : bytes + memory / step ** 3;
}

/**
 * Describes an image from its header.
 * @param {ImagePromise} promise @param {number} memory
 */
function promised({ size, voxel_type }, memory) {
  if (!size) return 'Reading';
  return `Reading ${size.join(' × ')} voxels of ${voxel_type}, about ${megabytes(memory)} MB of memory`;
}

/**
 * Reads a file into the core, without a copy of all of it here. Returns false if it is cancelled.
 * @param {Core} core @param {Blob} file @param {(share: number) => void} tell @param {() => boolean} isOver
 */
async function readInto(core, file, tell, isOver) {
  core.begin_file(file.size);
  const reader = file.stream().getReader();
  for (let at = 0; ; ) {
    const { done, value } = await reader.read();
    if (isOver()) {
      void reader.cancel();
      core.begin_file(0);
      return false;
    }
    if (done) return true;
    core.add_bytes(value);
    at += value.length;
    tell(at / file.size);
  }
}

/**
 * Opens a file in the core, which then owns it. Returns null if it is cancelled.
 * @param {Core} core @param {GivenFile} given @param {OpenEnv} env
 * @returns {Promise<Opened>}
 */
export async function openGiven(core, given, env) {
  try {
    return given.as === 'mesh' ? await openedMesh(core, given, env) : await openedImage(core, given, env);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) throw error;
    if (error instanceof Refusal) return { ok: false, kind: error.kind, message: error.message, step: error.step };
    return { ok: false, kind: given.as, message: `the file cannot be read: ${words(error)}` };
  }
}

/** @param {Core} core @param {GivenFile} given @param {OpenEnv} env @returns {Promise<Opened>} */
async function openedMesh(core, { name, file }, env) {
  const { tell, isOver, mostBytes } = env;
  const needed = MESH_FACTOR * file.size;
  if (needed > mostBytes)
    throw new Refusal(
      'mesh',
      `a mesh of ${megabytes(file.size)} MB takes about ${megabytes(needed)} MB of memory, and there are ` +
        `${megabytes(mostBytes)} MB here; simplify it first, or use the command line`,
    );
  const label = `Reading, about ${megabytes(needed)} MB of memory`;
  tell(label, 0);
  if (!(await readInto(core, file, (share) => tell(label, READ_SHARE * share), isOver))) return null;
  core.open_mesh(name);
  return (await openedInSlices(core, 'Mending the mesh', env)) && { ok: true, facts: null };
}

/** @param {Core} core @param {GivenFile} given @param {OpenEnv} env @returns {Promise<Opened>} */
async function openedImage(core, { name, file, beside, step = 1 }, env) {
  const { tell, isOver, mostBytes } = env;
  tell('Reading', 0);
  const start = new Uint8Array(await file.slice(0, START_BYTES).arrayBuffer());
  const promise = core.image_promise(name, start);
  if (!promise.ok) throw new Refusal('image', promise.error.message);
  const needed = memoryWith(step, promise);
  if (needed > mostBytes)
    throw new Refusal(
      'image',
      `the image of ${promise.size?.join(' × ')} voxels takes about ${megabytes(needed)} MB of memory, and ` +
        `there are ${megabytes(mostBytes)} MB here; cut out the part that matters, or keep fewer voxels`,
      STEPS.find((coarser) => coarser > step && memoryWith(coarser, promise) <= mostBytes),
    );
  const label = promised(promise, needed);
  tell(label, 0);
  /** @type {Map<string, Uint8Array>} */
  const others = new Map();
  for (const other of beside) {
    if (isOver()) return null;
    others.set(other.name, new Uint8Array(await other.file.arrayBuffer()));
  }
  if (!(await readInto(core, file, (share) => tell(label, READ_SHARE * share), isOver))) return null;
  if (step > 1) core.keep_one_in(step);
  core.open_image(name, (wanted) => others.get(wanted));
  const facts = /** @type {ImageFacts | null} */ (await openedInSlices(core, label, env));
  return facts && { ok: true, facts };
}

/**
 * Does the core's part of opening a file. Returns what it tells about it; null if it is cancelled.
 * @param {Core} core @param {string} label @param {OpenEnv} env
 */
async function openedInSlices(core, label, { tell, isOver, nowMs, pause }) {
  const opening = (/** @type {number} */ budget) => {
    const answer = core.open_step(budget);
    if (typeof answer !== 'number') return answer;
    tell(label, READ_SHARE + (1 - READ_SHARE) * answer);
    return undefined;
  };
  const interrupt = () => (isOver() ? 'over' : null);
  const { made: answer } = await inSlices(opening, { nowMs, pause, interrupt }, { first: FIRST_SLICES });
  if (!answer) {
    core.begin_file(0);
    return null;
  }
  if (!answer.ok) throw new Refusal(answer.error.kind, answer.error.message);
  const { ok: _, ...facts } = answer;
  return facts;
}
