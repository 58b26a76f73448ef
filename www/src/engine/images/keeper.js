/**
 * The image that the core in the worker has open. A job names the image it is of; if the core has another one, or has
 * been started anew, the file is opened again before the job begins.
 *
 * @module
 */
import { openImage } from './open.js';

/**
 * @import { Core } from '../../wasm/core/core.js'
 * @import { FieldAnswer, FieldRequest } from '../types.js'
 * @import { KeyedImage, Opened } from './types.js'
 */

/** @returns {FieldAnswer} */
const refusalOf = (/** @type {string} */ message) => ({
  ok: false,
  error: {
    kind: 'image',
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

export class ImageKeeper {
  #mostBytes;
  #begins;
  /** The key of the image that the core has open. */
  #key = '';
  /** The file that cannot be opened again, and why. */
  #refused = { key: '', message: '' };
  /** The key of the file that is being opened, and the number of that work. */
  #opening = { key: '', id: 0 };

  /**
   * @param {number} mostBytes  memory that an image may take
   * @param {() => void} [begins]  says that the core begins work during which nothing is heard of it
   */
  constructor(mostBytes, begins = () => {}) {
    this.#mostBytes = mostBytes;
    this.#begins = begins;
  }

  /**
   * Opens an image in the core. Another one that is being opened is given up.
   * @param {Core} core @param {KeyedImage} image @param {(label: string, fraction: number) => void} [tell]
   * @returns {Promise<Opened>}
   */
  async open(core, image, tell = this.#begins) {
    const id = this.#opening.id + 1;
    this.#opening = { key: image.key, id };
    const isOver = () => this.#opening.id !== id;
    const opened = await openImage(core, image, { tell, isOver, mostBytes: this.#mostBytes });
    if (opened?.ok) this.#key = image.key;
    if (isOver()) return null;
    this.#opening = { key: '', id };
    if (opened?.ok === false) this.#refused = { key: image.key, message: opened.message };
    return opened;
  }

  /** Gives up the image that is being opened. */
  stop() {
    this.#opening = { key: '', id: this.#opening.id + 1 };
  }

  /**
   * Whether the field of an image can be set. If it cannot yet, its file is opened, and `then` is called.
   * @param {Core} core @param {KeyedImage} image @param {(error?: unknown) => void} then
   */
  isReady(core, image, then) {
    if (this.#key === image.key || this.#refused.key === image.key) return true;
    if (this.#opening.key !== image.key) this.open(core, image).then(() => then(), then);
    return false;
  }

  /** @param {Core} core @param {KeyedImage} image @param {Partial<FieldRequest>} field @returns {FieldAnswer} */
  setField(core, image, field) {
    this.#begins();
    return this.#key === image.key ? core.set_image(field) : refusalOf(this.#refused.message);
  }
}
