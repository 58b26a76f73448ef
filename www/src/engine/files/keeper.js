/**
 * The file that the worker's core has open, and the field that is made of it. Each job names its file. If the core has
 * another one, or has been restarted, the file is opened again before the job begins. Then the field of the job is made
 * in slices, while the core samples the previous one.
 *
 * @module
 */
import { inSlices } from '../bundle/slices.js';
import { FIRST_SLICES, openGiven } from './open.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FieldAnswer, FieldRequest } from '../types.js'
 * @import { KeyedFile, MakeEnv, Opened, OpenEnv, Refused } from './types.js'
 */

/** Duration of a step while a field is made, several times that of a run, which goes on meanwhile. */
const MAKE_MS = 24;

/** @param {Refused} refused @returns {FieldAnswer} */
const refusalOf = ({ kind, message }) => ({
  ok: false,
  error: {
    kind,
    message,
    start: 0,
    end: 0,
    suggestion: null,
    choices: [],
    mended: null,
    name: null,
    excess: null,
  },
});

export class FileKeeper {
  #mostBytes;
  #env;
  #begins;
  /** The key of the core's open file. */
  #key = '';
  /** The file that cannot be opened again, and the reason. @type {Refused & {key: string}} */
  #refused = { key: '', kind: 'request', message: '' };
  /** The key of the file that is being opened, and the number of that attempt. */
  #opening = { key: '', id: 0 };
  /** The field that is made or was made, by its file and request, and whether that is done. */
  #field = { name: '', isMade: false };

  /**
   * @param {number} mostBytes  memory that a file may take
   * @param {Pick<OpenEnv, 'nowMs' | 'pause'>} env
   * @param {() => void} [begins]  called before the core is silent for long
   */
  constructor(mostBytes, env, begins = () => {}) {
    this.#mostBytes = mostBytes;
    this.#env = env;
    this.#begins = begins;
  }

  /**
   * Opens a file in the core. If another one is being opened, that is cancelled.
   * @param {Core} core @param {KeyedFile} file @param {(label: string, fraction: number) => void} [tell]
   * @returns {Promise<Opened>}
   */
  async open(core, file, tell = this.#begins) {
    const id = this.#opening.id + 1;
    this.#opening = { key: file.key, id };
    const isOver = () => this.#opening.id !== id;
    const opened = await openGiven(core, file, { ...this.#env, tell, isOver, mostBytes: this.#mostBytes });
    if (opened?.ok) this.#key = file.key;
    if (isOver()) return null;
    this.#opening = { key: '', id };
    if (opened?.ok === false) this.#refused = { key: file.key, kind: opened.kind, message: opened.message };
    return opened;
  }

  /** Cancels the opening of a file and the making of a field. */
  stop() {
    this.#opening = { key: '', id: this.#opening.id + 1 };
    this.#field = { name: '', isMade: false };
  }

  /**
   * Whether the field of a file can be set now. If not, the file is opened or the field made, and `whenReady` called.
   * @param {Core} core @param {KeyedFile} file @param {FieldRequest} request
   * @param {{tell?: (fraction: number) => void, whenReady: (error?: unknown) => void}} told
   */
  isReady(core, file, request, { tell = () => {}, whenReady }) {
    if (this.#refused.key === file.key) return true;
    if (this.#key !== file.key) {
      if (this.#opening.key !== file.key) this.open(core, file).then(() => whenReady(), whenReady);
      return false;
    }
    const name = `${file.key} ${JSON.stringify(request)}`;
    if (this.#field.name !== name) {
      this.#field = { name, isMade: false };
      const { lines = [] } = request;
      if (file.as === 'mesh')
        core.mark_edges(lines.flatMap((line) => line.slice(1).flatMap((to, k) => [...line[k], ...to])));
      const made = this.#make(core, request, { ...this.#env, tell });
      if (!this.#field.isMade) made.then(() => whenReady(), whenReady);
    }
    return this.#field.isMade;
  }

  /**
   * Makes a field in slices, unless another one is wanted before the end. A field that takes one slice is made at once.
   * @param {Core} core @param {FieldRequest} request @param {MakeEnv} env
   */
  async #make(core, request, { nowMs, pause, tell }) {
    const field = this.#field;
    const slice = (/** @type {number} */ budget) => {
      const share = core.make_opened(request, budget);
      field.isMade = share === 1;
      if (field.isMade) return true;
      tell(share);
      return undefined;
    };
    const interrupt = () => (this.#field === field ? null : 'other');
    await inSlices(slice, { nowMs, pause, interrupt }, { first: FIRST_SLICES, targetMs: MAKE_MS });
  }

  /** @param {Core} core @param {KeyedFile} file @param {FieldRequest} request @returns {FieldAnswer} */
  setField(core, file, request) {
    this.#field = { name: '', isMade: false };
    return this.#key === file.key ? core.set_opened(request) : refusalOf(this.#refused);
  }
}
