/**
 * The size of the picture: of its host in page pixels, of its canvas in pixels of the screen.
 *
 * @module
 */

/** More pixels than two per page pixel cannot be told apart, and cost as much again. */
const LARGEST_PIXEL_RATIO = 2;
/** The painter without a graphics card counts its pixels. */
const LARGEST_PAINTED_RATIO = 1;

export class Screen {
  /**
   * @param {HTMLElement} host
   * @param {() => void} onResize  the size or the pixel ratio may be another
   */
  constructor(host, onResize) {
    this.host = host;
    this.onResize = onResize;
    this.cssWidth = 0;
    this.cssHeight = 0;
    /** Size of the canvas. */
    this.width = 0;
    this.height = 0;
    /** Pixels of the canvas per page pixel. */
    this.ratio = 1;
    this.largestRatio = LARGEST_PIXEL_RATIO;
    this.observer = new ResizeObserver(() => this.measure());
    this.observer.observe(host);
    this.watchRatio();
    this.measure();
  }

  /** Another kind of device draws. @param {import('./backends.js').BackendKind} kind */
  drawnBy(kind) {
    this.largestRatio = kind === 'canvas2d' ? LARGEST_PAINTED_RATIO : LARGEST_PIXEL_RATIO;
    this.measure();
  }

  measure() {
    const { clientWidth, clientHeight } = this.host;
    const ratio = Math.min(this.largestRatio, devicePixelRatio || 1);
    this.cssWidth = clientWidth;
    this.cssHeight = clientHeight;
    this.width = Math.round(clientWidth * ratio);
    this.height = Math.round(clientHeight * ratio);
    this.ratio = ratio;
    this.onResize();
  }

  /** A window that moves to another monitor keeps its size and changes its pixels. */
  watchRatio() {
    this.monitor = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    this.monitor.onchange = () => {
      this.watchRatio();
      this.measure();
    };
  }

  close() {
    this.observer.disconnect();
    if (this.monitor) this.monitor.onchange = null;
  }
}
