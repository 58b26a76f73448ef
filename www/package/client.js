/**
 * The program's side of the sampler: sends it requests, in a worker or in the program's own thread, and holds the
 * samples.
 *
 * @module
 */
import { shown } from './checks.js';
import { DisposedError, errorOf, InputError, NoSurfaceError, WorkerError } from './errors.js';
import { checked, checkedCalls, paramsOf } from './options.js';
import { write } from './write.js';

/**
 * @import { Answered, Asked, Heard, Line, Made } from './protocol.js'
 * @import { Mesh, Options, Progress } from './index.js'
 */

/** Formats that hold only meshes, and those that hold particles. */
const MESHES = ['glb', '3mf', 'stl', 'obj'];
const PARTICLES = ['ply', 'csv', 'npy', 'xyz'];

/**
 * @typedef {{resolve: (value: any) => void, reject: (error: unknown) => void, onProgress?: Options['onProgress'],
 *   settled: () => void}} Pending
 */

/** A worker, which starts with its first request and again after a failure. */
class Client {
  #open;
  #lastId = 0;
  /** @type {Line | null} */
  #line = null;
  /** @type {Map<number, Pending>} */
  #pending = new Map();

  /** @param {(heard: Heard) => Line} open */
  constructor(open) {
    this.#open = open;
  }

  /** The worker's line. A sample compares it to see whether its particles still exist. */
  get line() {
    return this.#line;
  }

  /**
   * @param {(id: number) => Asked} question
   * @param {Pick<Options, 'signal' | 'onProgress'>} [how]
   * @returns {Promise<{id: number, value: any}>}
   */
  ask(question, { signal, onProgress } = {}) {
    if (signal?.aborted) return Promise.reject(signal.reason);
    this.#lastId += 1;
    const id = this.#lastId;
    return new Promise((resolve, reject) => {
      const abort = () => {
        this.#line?.post({ type: 'stop', id });
        // The caller no longer wants the worker's result.
        this.#settle(id)?.reject(signal?.reason);
      };
      this.#pending.set(id, {
        resolve: (value) => resolve({ id, value }),
        reject,
        onProgress,
        settled: () => signal?.removeEventListener('abort', abort),
      });
      signal?.addEventListener('abort', abort);
      try {
        this.#line ??= this.#opened();
        this.#line.hold(true);
        this.#line.post(question(id));
      } catch (error) {
        this.#settle(id)?.reject(new WorkerError(`The worker did not start: ${wordsOf(error)}`));
      }
    });
  }

  #opened() {
    const line = this.#open({
      onMessage: (message) => {
        if (this.#line === line) this.#receive(message);
      },
      onFail: (words) => {
        if (this.#line === line) this.#failed(new WorkerError(`The worker has failed: ${words}.`));
      },
    });
    return line;
  }

  /** @param {Answered} message */
  #receive({ id, value, error, progress }) {
    if (progress) {
      this.#tell(id, progress);
    } else if (error?.name === 'WorkerError') {
      this.#failed(errorOf(error));
    } else {
      const pending = this.#settle(id);
      if (error) pending?.reject(errorOf(error));
      else if (pending) pending.resolve(value);
      else this.#line?.post({ type: 'free', id });
    }
  }

  /**
   * Reports progress. An exception from the callback ends the sampling.
   * @param {number} id @param {Progress} progress
   */
  #tell(id, progress) {
    try {
      this.#pending.get(id)?.onProgress?.(progress);
    } catch (error) {
      this.#line?.post({ type: 'stop', id });
      this.#settle(id)?.reject(error);
    }
  }

  /** Ends the worker, whose memory cannot be trusted after an error. @param {Error} error */
  #failed(error) {
    this.#line?.end();
    this.#line = null;
    for (const id of [...this.#pending.keys()]) this.#settle(id)?.reject(error);
  }

  /** @param {number} id */
  #settle(id) {
    const pending = this.#pending.get(id);
    this.#pending.delete(id);
    pending?.settled();
    if (this.#pending.size === 0) this.#line?.hold(false);
    return pending;
  }
}

/** @param {unknown} error */
const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/** The particles of a surface. */
class Sample {
  #client;
  #line;
  #id;
  #isThere = true;
  #how;

  /**
   * @param {Client} client
   * @param {{id: number, value: Made}} answer
   * @param {ReturnType<typeof checked>} how
   */
  constructor(client, { id, value }, how) {
    this.#client = client;
    this.#line = client.line;
    this.#id = id;
    this.#how = how;
    const { count, points, normals, radii, levels, parents, report, bounds, parameters, values, digest } = value;
    /** Number of particles. */
    this.count = count;
    this.points = points;
    this.normals = normals;
    this.radii = radii;
    this.levels = levels;
    this.parents = parents;
    this.report = report;
    this.warnings = report?.warnings ?? [];
    this.bounds = bounds;
    this.params = Object.fromEntries(parameters.map((p) => [p.name, p.value]));
    this.values = values;
    this.image = value.image;
    this.original = value.original;
    this.change = value.change;
    this.digest = digest;
  }

  /** Joins the particles to triangles. @param {{weld?: boolean}} [how] @returns {Promise<Mesh>} */
  async mesh({ weld = false } = {}) {
    this.#check('mesh');
    const { value } = await this.#client.ask((id) => ({ type: 'mesh', id, of: this.#id, weld: weld === true }));
    return value;
  }

  /**
   * Writes the mesh or the particles as a file.
   * @param {string} format @param {{mesh?: boolean}} [how]
   * @returns {Promise<Uint8Array<ArrayBuffer>>}
   */
  async toFile(format, { mesh = MESHES.includes(format) } = {}) {
    this.#check('toFile');
    const known = mesh ? [...MESHES, 'ply'] : PARTICLES;
    if (!known.includes(format)) {
      const all = mesh ? known : [...MESHES, ...known];
      throw new InputError(`format: one of ${all.join(', ')}, not ${shown(format)}.`);
    }
    return this.#file(format, mesh === true);
  }

  /**
   * Saves the mesh or the particles in the format that the ending of a path names: in Node as a file, in a page as a
   * download of this name. Beside a CSV file goes one of the record, where there is one.
   * @param {string} path @param {{mesh?: boolean}} [how]
   */
  async save(path, how) {
    this.#check('save');
    const format = /\.([^./\\]+)$/.exec(path)?.[1].toLowerCase();
    if (format === undefined)
      throw new InputError(`path: a name with an ending, such as points.ply or part.stl, not ${shown(path)}.`);
    await write(path, await this.toFile(format, how));
    const record = format === 'csv' ? await this.#file('json', false) : undefined;
    if (record) await write(`${path}.json`, record);
  }

  /** @param {string} format @param {boolean} mesh */
  async #file(format, mesh) {
    const { value } = await this.#client.ask((id) => ({ type: 'file', id, of: this.#id, format, mesh }));
    return value.bytes;
  }

  /**
   * Moves the particles to the surface of other parameters. They leave this sample, which keeps its columns, and are
   * freed if they cannot follow.
   * @param {Record<string, number>} params @param {Pick<Options, 'signal' | 'onProgress'>} [options]
   */
  async moved(params, options = {}) {
    this.#check('moved');
    const { formula, cloud, given, solid } = this.#how.request;
    if (given ? formula !== undefined : formula === undefined || cloud || solid)
      throw new InputError(
        'moved(): it is for a formula, an image or a mesh by itself, not for functions, points or unions. Sample again.',
      );
    const parameters = { ...this.params, ...paramsOf(params, Object.keys(this.params)) };
    const how = { ...this.#how, ...checkedCalls(options) };
    if (how.signal?.aborted) throw how.signal.reason;
    this.#isThere = false;
    const { functions, settings, measure } = this.#how;
    const of = this.#id;
    const question = (/** @type {number} */ id) =>
      /** @type {const} */ ({ type: 'moved', id, of, field: { parameters }, functions, settings, measure });
    return new Sample(this.#client, await this.#client.ask(question, how), this.#how);
  }

  /** Frees the worker's memory once earlier requests are done. The columns stay. */
  dispose() {
    if (this.#isThere && this.#line === this.#client.line) this.#line?.post({ type: 'free', id: this.#id });
    this.#isThere = false;
  }

  [Symbol.dispose ?? Symbol.for('dispose')]() {
    this.dispose();
  }

  /** @param {string} method */
  #check(method) {
    if (!this.#isThere)
      throw new DisposedError(`${method}(): this sample was disposed of or has moved; its columns are still there.`);
    if (this.#line !== this.#client.line)
      throw new DisposedError(`${method}(): the worker that held the particles has failed. Sample again.`);
  }
}

/**
 * Returns the function `sample`. Functions are sampled through `openHere`, in the program's own thread, and everything
 * else through `open`.
 * @param {(heard: Heard) => Line} open @param {(heard: Heard) => Line} openHere
 */
export function createSampler(open, openHere) {
  const [there, here] = [new Client(open), new Client(openHere)];
  return async (/** @type {unknown} */ field, /** @type {Options} */ options = {}) => {
    const how = checked(field, options);
    const { settings, given, measure, request, functions } = how;
    const client = how.isHere ? here : there;
    const question = (/** @type {number} */ id) =>
      /** @type {const} */ ({ type: 'sample', id, field: request, functions, settings, given, measure });
    const answer = await client.ask(question, how).catch((error) => {
      // Its argument is a number, of which p[0] is undefined.
      if (error instanceof NoSurfaceError && typeof field === 'function' && field.length === 1)
        throw new NoSurfaceError(`${error.message} The function takes one argument, and is called with x, y and z.`);
      throw error;
    });
    return new Sample(client, answer, how);
  };
}
