/**
 * Decides when the camera fits the surface automatically: after a formula was typed or a link was read, and when the
 * surface disappears or reappears. It does so only while `camera.fit` is set.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/**
 * @import { Store } from './store.js'
 * @import { Columns } from './types.js'
 * @import { Viewer } from './view/viewer.js'
 */

/** Pause in typing after which the formula counts as finished. */
const TYPING_MS = 900;

export class Framing {
  #store;
  #columns;
  #viewer;

  /** Time at which the formula changed or a link was read, until the camera has fitted the surface; NaN otherwise. */
  #writtenMs;

  /** Whether the formula was typed. That keeps the camera where it is as long as the formula has no surface. */
  #isTyped;

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #effects;

  /** @param {{ store: Store, columns: Columns, viewer: Viewer }} parts */
  constructor({ store, columns, viewer }) {
    this.#store = store;
    this.#columns = columns;
    this.#viewer = viewer;
    this.#writtenMs = NaN;
    this.#isTyped = false;
    this.#timer = undefined;
    /** Whether the camera shows the whole box because there is no surface. */
    let boxShown = false;
    this.#effects = [
      effect(() => {
        if (!this.#rests() || Number.isNaN(this.#writtenMs) || this.#waits()) return;
        this.hold();
        // The camera waits for a pause in typing, so that the picture does not move with every key. A link is whole at
        // once.
        if (this.#isTyped)
          this.#timer = setTimeout(() => this.#come(), this.#writtenMs + TYPING_MS - performance.now());
        else queueMicrotask(() => this.#come());
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

  /** Notes that the formula changed or a link was read. @param {{typed: boolean}} how */
  written({ typed }) {
    this.#writtenMs = performance.now();
    this.#isTyped = typed;
  }

  /**
   * Returns whether the camera waits for a surface: the last one stays in the picture while a formula without one is
   * typed, and the camera stays with it.
   */
  #waits() {
    return this.#isTyped && this.#columns.stale;
  }

  /** Cancels the fit that the text typed so far would cause. */
  hold() {
    clearTimeout(this.#timer);
  }

  #come() {
    if (!this.#rests() || this.#waits()) return;
    this.#writtenMs = NaN;
    this.#fit();
  }

  #fit() {
    if (this.#viewer.camera.state.fit) this.#viewer.fit();
  }

  /**
   * Returns whether no run is active and the last one has a report or found no surface. A faulty formula makes no
   * difference: the surface still shown may come from an earlier state of the same text.
   */
  #rests() {
    const { busy, report, empty } = this.#store;
    return !busy.value && (report.value !== null || empty.value);
  }

  close() {
    this.hold();
    for (const stop of this.#effects) stop();
  }
}
