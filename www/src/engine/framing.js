/**
 * Decides when the camera fits the surface automatically: after a formula was typed, a link was read or the box was
 * enlarged, and when the surface disappears or reappears. A typed formula is on trial until another pause has passed;
 * if the previous surface returns before that, so does the camera. The camera moves only while `camera.fit` is set. An
 * enlarged box, and a formula that replaces another one, set it again.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { TYPING_MS } from './constants.js';
import { homeCamera } from './view/camera.js';

/**
 * @import { Store } from './store.js'
 * @import { Angles, CameraState, Columns } from './types.js'
 * @import { Viewer } from './view/viewer.js'
 */

export class Framing {
  #store;
  #columns;
  #viewer;

  /** Whether the formula changed or a link was read since the camera last fitted the surface. */
  #isWritten;

  /** The last angles that the page gave the camera. @type {Angles} */
  #angles;

  /** Whether another surface was typed that the camera has not shown yet. */
  #isAnother;

  /** Whether the formula was typed. Then the camera stays while the formula has no surface. */
  #isTyped;

  #effects;

  /**
   * `keep` ends the trial of a formula, which stays.
   * @param {{ store: Store, columns: Columns, viewer: Viewer, keep: () => void }} parts
   */
  constructor({ store, columns, viewer, keep }) {
    this.#store = store;
    this.#columns = columns;
    this.#viewer = viewer;
    this.#isWritten = false;
    this.#isTyped = false;
    this.#isAnother = false;
    this.#angles = homeCamera();
    /** Whether the camera shows the whole box because there is no surface. */
    let boxShown = false;
    /** The camera before the first trial began. @type {CameraState | null} */
    let before = null;
    this.#effects = [
      effect(() => {
        if (this.#rests() && this.#isWritten && !this.#waits()) queueMicrotask(() => this.#come());
      }),
      effect(() => {
        if (store.trial.value !== 'shown' || !this.#rests() || this.#waits()) return;
        const timer = setTimeout(keep, TYPING_MS);
        return () => clearTimeout(timer);
      }),
      effect(() => {
        const trial = store.trial.value;
        if (trial === 'typing') return;
        if (trial === 'shown') before ??= viewer.camera.state;
        else {
          if (before && trial === 'back') this.#back(before);
          before = null;
        }
      }),
      effect(() => {
        // Without a surface the camera shows the box, and returns to the surface when one appears.
        const none = store.result.value === 'none' && columns.count === 0;
        const rests = store.status.value !== 'sampling' && !store.progress.value.live;
        if (!rests || none === boxShown) return;
        boxShown = none;
        queueMicrotask(() => this.#fit());
      }),
    ];
  }

  /**
   * Records that the formula changed, a link was read or the box was enlarged.
   * @param {{typed: boolean, another?: boolean}} how  `another`: the formula took the place of another one
   */
  written({ typed, another = false }) {
    this.#isWritten = true;
    this.#isTyped = typed;
    if (typed) this.#viewer.linked = null;
    this.#isAnother = typed && (this.#isAnother || another);
  }

  /** Records that a surface was restored together with its camera, which stays. */
  restored() {
    this.#isWritten = false;
    this.#isTyped = false;
    this.#isAnother = false;
  }

  /** Fits the next surface, even if a pointer has moved the camera. */
  enlarged() {
    this.#follow();
    this.#viewer.linked = null;
    this.written({ typed: false });
  }

  /**
   * Whether the camera waits for a surface. While a typed formula has no surface, the last surface and the camera stay.
   */
  #waits() {
    return this.#isTyped && this.#columns.stale;
  }

  #come() {
    if (!this.#rests() || this.#waits()) return;
    this.#isWritten = false;
    // While the formula has an error, the previous surface stays as it was seen.
    if (this.#isTyped && this.#store.fieldError.value === null) this.#turn();
    this.#fit();
  }

  /**
   * Shows a typed surface from where its outline is largest. If the formula is another one, always; else only if no
   * pointer has turned the camera.
   */
  #turn() {
    const { camera } = this.#viewer;
    const isAnother = this.#isAnother;
    if (this.#columns.count === 0 || (!isAnother && (!camera.state.fit || this.#isTurned()))) return;
    this.#isAnother = false;
    if (isAnother) this.#follow();
    this.#viewer.turnWide(isAnother ? homeCamera() : camera.end);
    this.#store.turned.value += 1;
    this.#angles = camera.end;
  }

  /** Whether a pointer has turned the camera since the page did. */
  #isTurned() {
    const { end } = this.#viewer.camera;
    return Math.hypot(end.yaw - this.#angles.yaw, end.pitch - this.#angles.pitch) > 1e-3;
  }

  /** Moves the camera back, but keeps a rotation made since then. @param {CameraState} before */
  #back(before) {
    const { camera } = this.#viewer;
    if (!camera.state.fit) return;
    const { target, distance } = before;
    if (this.#isTurned()) camera.set({ ...camera.state, target, distance });
    else {
      camera.set(before);
      this.#angles = camera.end;
    }
    this.#viewer.moved();
  }

  /** Lets the camera fit the surface again after a pointer has moved it. */
  #follow() {
    const { camera } = this.#viewer;
    if (!camera.state.fit) camera.set({ ...camera.state, fit: true });
  }

  #fit() {
    if (this.#viewer.camera.state.fit) this.#viewer.fit();
  }

  /**
   * Whether nobody types, no run is active and the last run has a report or found no surface. A faulty formula makes no
   * difference: the surface shown may come from an earlier state of the same text.
   */
  #rests() {
    const { status, trial, report, result } = this.#store;
    const isAtWork = trial.value === 'typing' || status.value === 'sampling';
    return !isAtWork && (report.value !== null || result.value === 'none');
  }

  close() {
    for (const stop of this.#effects) stop();
  }
}
