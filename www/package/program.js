/**
 * Calls functions of the program for the core, for up to 512 points at a time.
 *
 * @module
 */

/** @import { Batch, OfPlace, Pieces } from './index.js' */

/** Marks values that a function has not written; no function returns this one. */
const UNWRITTEN = -Number.MAX_VALUE;

/** A sentence about what the function did wrong. */
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
 * A function of one point or of many, or pieces with their labels. Keeps the error of a call, since the core reports
 * only that there was one.
 */
export class Program {
  #what;
  #write;
  /** Writes the labels of pieces at points; missing for a single function. */
  labels;
  /**
   * What went wrong: a sentence, and the error that the function threw.
   * @type {{message: string, cause: unknown} | null}
   */
  failure = null;

  /** @param {OfPlace | Batch | Pieces} field @param {string} [what]  its name in errors */
  constructor(field, what = 'The function that is sampled') {
    this.#what = what;
    if (typeof field === 'function') this.#write = ofPoint(field);
    else if ('batch' in field) this.#write = ofBatch(field);
    else {
      const pieces = field.pieces.map(ofPoint);
      this.#write = (/** @type {Float64Array} */ xyz, /** @type {Float64Array} */ out, piece = 0) =>
        pieces[piece](xyz, out);
      const write = labelsOf(field);
      this.labels = (/** @type {Float64Array} */ xyz, /** @type {Uint32Array} */ out) =>
        this.#called(() => write(xyz, out));
    }
  }

  /** Writes f, or the piece, at each point. @param {Float64Array} xyz @param {Float64Array} out @param {number} [piece] */
  call = (xyz, out, piece) => this.#called(() => this.#write(xyz, out, piece));

  /** @param {() => void} call */
  #called(call) {
    try {
      call();
    } catch (error) {
      const words = error instanceof Error ? error.message : String(error);
      const said = error instanceof Misuse ? '' : 'it threw: ';
      this.failure ??= { message: `${this.#what} has failed: ${said}${words}`, cause: error };
      throw error;
    }
  }
}

/** @param {Pieces} field */
function labelsOf({ label, pieces }) {
  return (/** @type {Float64Array} */ xyz, /** @type {Uint32Array} */ out) => {
    for (let i = 0, at = 0; i < out.length; i += 1, at += 3) {
      const piece = Number(label(xyz[at], xyz[at + 1], xyz[at + 2]));
      if (!(piece in pieces))
        throw new Misuse(
          `label(${xyz[at]}, ${xyz[at + 1]}, ${xyz[at + 2]}) returned ${piece}: it is the index of a piece, from 0 to ${pieces.length - 1}`,
        );
      out[i] = piece;
    }
  };
}

/** @param {OfPlace} f */
function ofPoint(f) {
  return (/** @type {Float64Array} */ xyz, /** @type {Float64Array} */ out) => {
    for (let i = 0, at = 0; i < out.length; i += 1, at += 3) {
      const value = f(xyz[at], xyz[at + 1], xyz[at + 2]);
      if (typeof value !== 'number') {
        refusePromise(value);
        throw new Misuse(`f(x, y, z) returned ${typeof value} in place of a number`);
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
