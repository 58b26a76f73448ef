/**
 * Tracks the size of the picture: the host in page pixels and the canvas in screen pixels.
 *
 * @module
 */

/** @import { BackendKind } from '../types.js' */

/** Largest pixel ratio. Finer pixels are not visible but cost drawing time. */
const LARGEST_PIXEL_RATIO = 2;
/** Largest pixel ratio of the painter, whose cost grows with the number of pixels. */
const LARGEST_PAINTED_RATIO = 1;

export class Screen {
  #host;
  #onResize;
  #largestRatio;
  #observer;

  /**
   * @param {HTMLElement} host
   * @param {() => void} onResize  the size or the pixel ratio may have changed
   */
  constructor(host, onResize) {
    this.#host = host;
    this.#onResize = onResize;
    this.cssWidth = 0;
    this.cssHeight = 0;
    /** Size of the canvas in its own pixels. */
    this.width = 0;
    this.height = 0;
    /** Canvas pixels per page pixel. */
    this.ratio = 1;
    this.#largestRatio = LARGEST_PIXEL_RATIO;
    this.#observer = new ResizeObserver(() => this.#measure());
    this.#observer.observe(host);
    this.#watchRatio();
    this.#measure();
  }

  /** Adopts the pixel ratio limit of a kind of device. @param {BackendKind} kind */
  drawnBy(kind) {
    this.#largestRatio = kind === 'canvas2d' ? LARGEST_PAINTED_RATIO : LARGEST_PIXEL_RATIO;
    this.#measure();
  }

  #measure() {
    const { clientWidth, clientHeight } = this.#host;
    const ratio = Math.min(this.#largestRatio, devicePixelRatio || 1);
    this.cssWidth = clientWidth;
    this.cssHeight = clientHeight;
    this.width = Math.round(clientWidth * ratio);
    this.height = Math.round(clientHeight * ratio);
    this.ratio = ratio;
    this.#onResize();
  }

  /** Watches the pixel ratio, which changes without a resize when a window moves to another monitor. */
  #watchRatio() {
    this.monitor = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    this.monitor.onchange = () => {
      this.#watchRatio();
      this.#measure();
    };
  }

  close() {
    this.#observer.disconnect();
    if (this.monitor) this.monitor.onchange = null;
  }
}
