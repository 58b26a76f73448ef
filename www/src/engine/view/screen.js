/**
 * Tracks the size of the picture: the host in page pixels and the canvas in screen pixels.
 *
 * @module
 */

/** Largest pixel ratio; finer pixels cost drawing time and are not visible. */
const LARGEST_PIXEL_RATIO = 2;

export class Screen {
  #host;
  #onResize;
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
    this.#observer = new ResizeObserver(() => this.#measure());
    this.#observer.observe(host);
    this.#watchRatio();
    this.#measure();
  }

  #measure() {
    const { clientWidth, clientHeight } = this.#host;
    const ratio = Math.min(LARGEST_PIXEL_RATIO, devicePixelRatio || 1);
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
