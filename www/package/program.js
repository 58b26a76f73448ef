/**
 * Functions of the program as the core calls them: up to 512 points at a time.
 *
 * @module
 */

/** @import { Batch } from './index.js' */

/** What no function gives: a value that it has not written is still this one. */
const UNWRITTEN = -Number.MAX_VALUE;

/** What the function did wrong, in words. */
class Misuse extends Error {}

/** @param {unknown} value */
const isPromise = (value) => typeof Object(value).then === 'function';

/** @param {unknown} value */
function refusePromise(value) {
  if (!isPromise(value)) return;
  Promise.resolve(value).catch(() => {});
  throw new Misuse('it returned a promise: it has to give its values before it returns');
}

/**
 * A function of a point, or of a batch of points. The error of a call is kept: the core says only
 * that there was one.
 */
export class Program {
  #write;
  /**
   * What went wrong: a sentence, and the error that the function threw.
   * @type {{message: string, cause: unknown} | null}
   */
  failure = null;

  /** @param {((x: number, y: number, z: number) => number) | Batch} field */
  constructor(field) {
    this.#write = typeof field === 'function' ? ofPoint(field) : ofBatch(field);
  }

  /** Writes f at each point. @param {Float64Array} xyz @param {Float64Array} out */
  call = (xyz, out) => {
    try {
      this.#write(xyz, out);
    } catch (error) {
      const words = error instanceof Error ? error.message : String(error);
      const said = error instanceof Misuse ? '' : 'it threw: ';
      this.failure ??= { message: `The function that is sampled has failed: ${said}${words}`, cause: error };
      throw error;
    }
  };
}

/** @param {(x: number, y: number, z: number) => number} f */
function ofPoint(f) {
  return (/** @type {Float64Array} */ xyz, /** @type {Float64Array} */ out) => {
    for (let i = 0, at = 0; i < out.length; i += 1, at += 3) {
      const value = f(xyz[at], xyz[at + 1], xyz[at + 2]);
      if (typeof value !== 'number') {
        refusePromise(value);
        throw new Misuse(`it returned ${typeof value} in place of a number`);
      }
      out[i] = value;
    }
  };
}

/** @param {Batch} field */
function ofBatch(field) {
  return (/** @type {Float64Array} */ xyz, /** @type {Float64Array} */ out) => {
    out.fill(UNWRITTEN);
    refusePromise(field.batch(xyz, out));
    const missing = out.reduce((sum, value) => sum + Number(value === UNWRITTEN), 0);
    if (missing > 0)
      throw new Misuse(
        `batch(xyz, out) wrote ${out.length - missing} of ${out.length} values: out has one for each point`,
      );
  };
}
