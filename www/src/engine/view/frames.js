/**
 * Schedules frames: on demand, at most one per browser frame, and none while the picture is out of sight.
 *
 * @module
 */

/** @import { FrameResult } from './types.js' */

/** Delay before a frame that the screen did not accept is drawn again, and the most such attempts. */
const RETRY_MS = 60;
const MOST_SKIPS = 20;
/** Largest time step; prevents a jump in the first frame after a pause. */
const LONGEST_STEP_S = 1 / 20;

/** Returns the time for all animations, in seconds. */
export const nowS = () => performance.now() / 1000;

export class FrameLoop {
  #draw;
  #lastS;

  /** Number of consecutive frames that the screen did not accept. */
  #skipped;

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #retry;
  #onVisible;

  /** Whether the picture is visible, as far as is known. */
  #isSeen = true;

  /** Whether the last frame was partial, and whether another was requested since its first part. */
  #isPart = false;
  #isLate = false;

  /** @param {(nowS: number, dtS: number) => FrameResult} draw  draws one frame and may request the next */
  constructor(draw) {
    this.#draw = draw;
    /** Handle of the requested frame, 0 for none. */
    this.asked = 0;
    this.#lastS = 0;
    /** Number of frames that the screen accepted. */
    this.drawn = 0;
    this.#skipped = 0;
    this.#retry = undefined;
    /** Callbacks to run after the next frame. @type {(() => void)[]} */
    this.waiting = [];
    // On some systems a hidden tab loses its picture.
    this.#onVisible = () => {
      if (this.isHidden) this.#flush();
      else this.ask();
    };
    document.addEventListener('visibilitychange', this.#onVisible);
  }

  /** Requests a frame. Changes during a partial frame appear in the next frame. */
  ask() {
    this.#isLate ||= this.#isPart;
    this.#request();
  }

  /** Whether the picture is out of sight: its tab is hidden, or another part of the page is shown. */
  get isHidden() {
    return document.hidden || !this.#isSeen;
  }

  /** @param {boolean} isSeen  whether the picture is in sight */
  see(isSeen) {
    this.#isSeen = isSeen;
    if (!isSeen) cancelAnimationFrame(this.asked);
    if (!isSeen) this.asked = 0;
    this.#onVisible();
  }

  #request() {
    if (this.asked === 0 && !this.isHidden) this.asked = requestAnimationFrame(() => this.#frame());
  }

  /** @param {() => void} onDrawn  called after the next frame */
  afterNext(onDrawn) {
    this.waiting.push(onDrawn);
  }

  #flush() {
    const { waiting } = this;
    this.waiting = [];
    for (const drawn of waiting) drawn();
  }

  #frame() {
    this.asked = 0;
    const now = nowS();
    const step = Math.min(now - this.#lastS, LONGEST_STEP_S);
    this.#lastS = now;
    const result = this.#draw(now, step);
    // Callbacks wait for the complete frame.
    this.#isPart = result === 'part';
    if (this.#isPart) return this.#request();
    if (this.#isLate) this.#request();
    this.#isLate = false;
    if (result === 'drawn') {
      this.drawn += 1;
      this.#skipped = 0;
    } else if (result === 'skipped' && this.#skipped < MOST_SKIPS) {
      this.#skipped += 1;
      this.#retry = setTimeout(() => this.ask(), RETRY_MS);
    }
    this.#flush();
  }

  close() {
    cancelAnimationFrame(this.asked);
    clearTimeout(this.#retry);
    document.removeEventListener('visibilitychange', this.#onVisible);
    this.#flush();
  }
}
