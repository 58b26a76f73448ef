/**
 * The file that the worker's core has open. Each job names its file. If the core has another one, or has been
 * restarted, the file is opened again before the job begins.
 *
 * @module
 */
import { openGiven } from './open.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FieldAnswer, FieldRequest } from '../types.js'
 * @import { KeyedFile, Opened, Refused } from './types.js'
 */

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
  #begins;
  /** The key of the core's open file. */
  #key = '';
  /** The file that cannot be opened again, and the reason. @type {Refused & {key: string}} */
  #refused = { key: '', kind: 'request', message: '' };
  /** The key of the file that is being opened, and the number of that attempt. */
  #opening = { key: '', id: 0 };

  /**
   * @param {number} mostBytes  memory that a file may take
   * @param {() => void} [begins]  called before the core is silent for long
   */
  constructor(mostBytes, begins = () => {}) {
    this.#mostBytes = mostBytes;
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
    const opened = await openGiven(core, file, { tell, isOver, mostBytes: this.#mostBytes });
    if (opened?.ok) this.#key = file.key;
    if (isOver()) return null;
    this.#opening = { key: '', id };
    if (opened?.ok === false) this.#refused = { key: file.key, kind: opened.kind, message: opened.message };
    return opened;
  }

  /** Cancels the opening of a file. */
  stop() {
    this.#opening = { key: '', id: this.#opening.id + 1 };
  }

  /**
   * Whether the field of a file can be set now. If not, the file is opened and `then` is called.
   * @param {Core} core @param {KeyedFile} file @param {(error?: unknown) => void} then
   */
  isReady(core, file, then) {
    if (this.#key === file.key || this.#refused.key === file.key) return true;
    if (this.#opening.key !== file.key) this.open(core, file).then(() => then(), then);
    return false;
  }

  /** @param {Core} core @param {KeyedFile} file @param {Partial<FieldRequest>} field @returns {FieldAnswer} */
  setField(core, file, field) {
    this.#begins();
    return this.#key === file.key ? core.set_opened(field) : refusalOf(this.#refused);
  }
}
