/**
 * Tracks the pointers pressed on the picture: one rotates or pans, two pan and zoom, a short press is a tap. Instead, a
 * press may grab something in the picture; then other pointers wait until it is released.
 *
 * A drag ends with the release, the cancellation or the lost capture of its pointer.
 *
 * @module
 */

/**
 * @import { Hold } from '../types.js'
 * @import { Place, Stage } from './types.js'
 */

/** Rotation for a drag across the whole shorter side. */
const TURN_PER_SIDE_RAD = Math.PI * 0.9;
/** Largest motion and duration of a tap. */
const TAP_PX = 4;
const TAP_MS = 400;
/** Duration at the end of a drag over which the release speed is measured, and the largest number of its steps. */
const THROW_MS = 80;
const MOST_STEPS = 64;
/** Shortest duration for computing a speed, and smallest distance between fingers for computing a scale. */
const LEAST_THROW_MS = 8;
const LEAST_SPAN_PX = 8;

/** @param {HTMLElement} host @param {{clientX: number, clientY: number}} event @returns {Place} */
export function placeOn(host, event) {
  const box = host.getBoundingClientRect();
  return { x: event.clientX - box.left, y: event.clientY - box.top };
}

/** Zooms by a factor towards a point. @param {Stage} stage @param {number} factor @param {Place} at */
export function zoomAt({ camera, currentView }, factor, at) {
  camera.zoom(factor, { view: currentView(), xPx: at.x, yPx: at.y });
}

export class Pointers {
  #panning;

  /** @param {Stage} stage */
  constructor(stage) {
    this.stage = stage;
    /** Position of each pressed pointer. @type {Map<number, Place>} */
    this.held = new Map();
    this.#panning = false;
    /** The press that may still become a tap. @type {(Place & {atMs: number, still: boolean}) | null} */
    this.press = null;
    /** What the first pointer has grabbed. @type {Hold | null} */
    this.hold = null;
    /** The last steps of a rotation. @type {{dx: number, dy: number, atMs: number}[]} */
    this.trail = [];
  }

  /** @param {PointerEvent} event */
  down(event) {
    const { host, camera, leave, take } = this.stage;
    if (this.hold) return;
    camera.rest();
    const at = placeOn(host, event);
    this.held.set(event.pointerId, at);
    try {
      host.setPointerCapture(event.pointerId);
    } catch {
      // The pointer is already gone; its end event still follows.
    }
    this.#panning = event.button !== 0 || event.shiftKey;
    this.trail = [];
    this.press = this.held.size === 1 ? { ...at, atMs: event.timeStamp, still: true } : null;
    leave(true);
    if (event.button === 0 && this.held.size === 1) this.hold = take(at, event.shiftKey);
  }

  /** @param {PointerEvent} event  of a pressed pointer */
  move(event) {
    const { held, press, stage } = this;
    const before = held.get(event.pointerId);
    if (!before) return;
    const at = placeOn(stage.host, event);
    if (press?.still && Math.hypot(at.x - press.x, at.y - press.y) > TAP_PX) press.still = false;
    if (held.size === 1) {
      if (press?.still) return;
      if (this.hold) return this.hold.drag(at);
      this.#drag(at.x - before.x, at.y - before.y, event.timeStamp);
    } else if (held.size === 2) {
      const other = [...held].find(([id]) => id !== event.pointerId)?.[1] ?? at;
      this.#pinch(before, at, other);
    }
    held.set(event.pointerId, at);
    stage.moved();
  }

  /** @param {number} dx @param {number} dy @param {number} atMs */
  #drag(dx, dy, atMs) {
    const { camera, currentView } = this.stage;
    if (this.#panning) {
      camera.pan(dx, dy, currentView());
      return;
    }
    camera.orbit(dx * this.#radPerPx(), dy * this.#radPerPx());
    this.trail.push({ dx, dy, atMs });
    if (this.trail.length > MOST_STEPS) this.trail.shift();
  }

  /**
   * Handles the motion of one of two fingers.
   * @param {Place} before
   * @param {Place} at
   * @param {Place} other  position of the other
   */
  #pinch(before, at, other) {
    const { camera, currentView } = this.stage;
    const spanBefore = Math.hypot(before.x - other.x, before.y - other.y);
    const span = Math.hypot(at.x - other.x, at.y - other.y);
    camera.pan((at.x - before.x) / 2, (at.y - before.y) / 2, currentView());
    if (spanBefore > LEAST_SPAN_PX && span > LEAST_SPAN_PX) {
      zoomAt(this.stage, span / spanBefore, { x: (at.x + other.x) / 2, y: (at.y + other.y) / 2 });
    }
  }

  /**
   * @param {PointerEvent} event
   * @param {boolean} released  true if the user released it, false if the browser cancelled it
   */
  end(event, released) {
    const { held, press, stage } = this;
    if (!held.delete(event.pointerId)) return;
    const trail = this.trail;
    this.press = null;
    this.trail = [];
    if (this.hold) {
      this.hold.drop();
      this.hold = null;
      return;
    }
    if (held.size > 0) {
      // The remaining finger continues from its position.
      this.#panning = false;
      return;
    }
    const at = placeOn(stage.host, event);
    if (released && press?.still && event.timeStamp - press.atMs < TAP_MS && event.button === 0) {
      stage.point(at.x, at.y, true);
    } else if (released && !this.#panning) {
      this.#throw(trail, event.timeStamp);
    }
    stage.moved();
  }

  /** Continues the rotation at the speed of the release. @param {Pointers['trail']} trail @param {number} nowMs */
  #throw(trail, nowMs) {
    const recent = trail.filter((step) => nowMs - step.atMs < THROW_MS);
    const since = recent.length ? nowMs - recent[0].atMs : 0;
    if (since <= LEAST_THROW_MS) return;
    const perS = (this.#radPerPx() * 1000) / since;
    const sum = (/** @type {'dx' | 'dy'} */ key) => recent.reduce((total, step) => total + step[key], 0);
    this.stage.camera.fling(sum('dx') * perS, sum('dy') * perS);
  }

  #radPerPx() {
    const { clientWidth, clientHeight } = this.stage.host;
    return TURN_PER_SIDE_RAD / Math.max(1, Math.min(clientWidth, clientHeight));
  }
}
