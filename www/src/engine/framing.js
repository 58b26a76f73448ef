/**
 * Decides when the camera fits the surface automatically: after a formula was typed, a link was read or the box was
 * enlarged, and when the surface disappears or reappears. A formula that is still being typed is kept once it has stood
 * for another pause. If it gives way to the surface before, the camera goes back, too. The camera moves only while
 * `camera.fit` is set, which it is again for an enlarged box and for a formula that takes the place of another.
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

  /** Whether the formula changed or a link was read, and the camera has not fitted the surface since. */
  #isWritten;

  /** The angles that the page gave the camera last. @type {Angles} */
  #angles;

  /** Whether another surface was typed, which the camera has not shown since. */
  #isAnother;

  /** Whether the formula was typed. That keeps the camera where it is as long as the formula has no surface. */
  #isTyped;

  #effects;

  /**
   * `keep` keeps the formula that was on trial.
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
    /** Where the camera was when the first trial began. @type {CameraState | null} */
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
        if (trial === 'shown') before ??= viewer.camera.state;
        else {
          if (before && trial === 'back') this.#back(before);
          before = null;
        }
      }),
      effect(() => {
        // Without a surface the camera shows the box. It returns to the surface when there is one again.
        const none = store.empty.value && columns.count === 0;
        const rests = !store.busy.value && !store.progress.value.live;
        if (!rests || none === boxShown) return;
        boxShown = none;
        queueMicrotask(() => this.#fit());
      }),
    ];
  }

  /**
   * Notes that the formula changed, a link was read or the box was made larger.
   * @param {{typed: boolean, another?: boolean}} how  `another`: the formula took the place of another one
   */
  written({ typed, another = false }) {
    this.#isWritten = true;
    this.#isTyped = typed;
    if (typed) this.#viewer.linked = null;
    this.#isAnother = typed && (this.#isAnother || another);
  }

  /** Notes that a surface was restored with its camera, which stays: what was written before is gone. */
  restored() {
    this.#isWritten = false;
    this.#isTyped = false;
    this.#isAnother = false;
  }

  /** Fits the surface that is to come, wherever the hand has left the camera. */
  enlarged() {
    this.#follow();
    this.#viewer.linked = null;
    this.written({ typed: false });
  }

  /**
   * Returns whether the camera waits for a surface: the last one stays in the picture while a formula without one is
   * typed, and the camera stays with it.
   */
  #waits() {
    return this.#isTyped && this.#columns.stale;
  }

  #come() {
    if (!this.#rests() || this.#waits()) return;
    this.#isWritten = false;
    // Beside a mistake stands the surface before, as it was seen.
    if (this.#isTyped && this.#store.fieldError.value === null) this.#turn();
    this.#fit();
  }

  /**
   * Shows a typed surface from where its outline is largest: another one wherever the hand has left the camera, else
   * unless the hand has turned it.
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

  /** Whether the hand has turned the camera since the page did. */
  #isTurned() {
    const { end } = this.#viewer.camera;
    return Math.hypot(end.yaw - this.#angles.yaw, end.pitch - this.#angles.pitch) > 1e-3;
  }

  /** Goes back to where the camera was, turned as the hand has turned it since. @param {CameraState} before */
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

  /** Has the camera fit the surface again, after the hand had taken it. */
  #follow() {
    const { camera } = this.#viewer;
    if (!camera.state.fit) camera.set({ ...camera.state, fit: true });
  }

  #fit() {
    if (this.#viewer.camera.state.fit) this.#viewer.fit();
  }

  /**
   * Returns whether nobody types, no run is active and the last one has a report or found no surface. A faulty formula
   * makes no difference: the surface still shown may come from an earlier state of the same text.
   */
  #rests() {
    const { busy, typing, report, empty } = this.#store;
    return !typing.value && !busy.value && (report.value !== null || empty.value);
  }

  close() {
    for (const stop of this.#effects) stop();
  }
}
