/**
 * When to draw: on demand, at most once per frame of the browser. While nobody asks, no frame is drawn.
 *
 * @module
 */

/** A picture that the screen did not take is drawn again this much later, and so many times. */
const RETRY_MS = 60;
const MOST_SKIPS = 20;
/** After a pause the first step is one frame long: nothing jumps. */
const LONGEST_STEP_S = 1 / 20;

/** The clock of everything that moves in the picture. */
export const nowS = () => performance.now() / 1000;

/**
 * What became of a frame. `skipped`: the screen was not ready to take the picture, so it has not been seen; `none`: there was
 * nothing to draw with, or nothing to draw on.
 * @typedef {'drawn' | 'skipped' | 'none'} Outcome
 */

export class FrameLoop {
  /** @param {(nowS: number, dtS: number) => Outcome} draw  draws one frame; it may ask for the next */
  constructor(draw) {
    this.draw = draw;
    /** The frame asked for of the browser, 0 for none. */
    this.asked = 0;
    this.lastS = 0;
    /** Frames that the screen took. */
    this.drawn = 0;
    /** Frames in a row that it did not take. */
    this.skipped = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.retry = undefined;
    /** Called when what they wait for is on screen. @type {(() => void)[]} */
    this.waiting = [];
    this.frame = this.frame.bind(this);
    // A tab that comes back has lost its last picture on some systems.
    this.onVisible = () => {
      if (document.hidden) this.flush();
      else this.ask();
    };
    document.addEventListener('visibilitychange', this.onVisible);
  }

  /** Asks for a frame. */
  ask() {
    if (this.asked === 0 && !document.hidden) this.asked = requestAnimationFrame(this.frame);
  }

  /** @param {() => void} onDrawn  called after the next frame */
  afterNext(onDrawn) {
    this.waiting.push(onDrawn);
  }

  flush() {
    const { waiting } = this;
    this.waiting = [];
    for (const drawn of waiting) drawn();
  }

  frame() {
    this.asked = 0;
    const now = nowS();
    const step = Math.min(now - this.lastS, LONGEST_STEP_S);
    this.lastS = now;
    const outcome = this.draw(now, step);
    if (outcome === 'drawn') {
      this.drawn += 1;
      this.skipped = 0;
    } else if (outcome === 'skipped' && this.skipped < MOST_SKIPS) {
      this.skipped += 1;
      this.retry = setTimeout(() => this.ask(), RETRY_MS);
    }
    this.flush();
  }

  close() {
    cancelAnimationFrame(this.asked);
    clearTimeout(this.retry);
    document.removeEventListener('visibilitychange', this.onVisible);
    this.flush();
  }
}
