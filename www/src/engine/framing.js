/**
 * When the camera comes to the surface by itself: after a formula was typed or a link read, and where a surface goes or comes
 * back. Only while the camera follows the surface (`camera.fit`).
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** After so long without a key the formula counts as written. */
const TYPING_MS = 900;

export class Framing {
  /**
   * @param {object} parts
   * @param {import('./store.js').Store} parts.store
   * @param {import('./columns.js').Columns} parts.columns
   * @param {import('./view/viewer.js').Viewer} parts.viewer
   * @param {import('./look.js').Look} parts.look
   */
  constructor({ store, columns, viewer, look }) {
    this.store = store;
    this.viewer = viewer;
    /** When the formula was changed or a link read, until the camera comes to the surface. */
    this.writtenMs = NaN;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    /** The camera shows the whole box, for want of a surface. */
    let boxShown = false;
    this.effects = [
      effect(() => {
        if (!this.rests() || Number.isNaN(this.writtenMs)) return;
        this.hold();
        // Once the typing rests: the picture stands still meanwhile.
        this.timer = setTimeout(() => this.come(), this.writtenMs + TYPING_MS - performance.now());
      }),
      effect(() => {
        // Where there is no surface the box is all there is to see; once there is one again, the camera comes back to it.
        const none = store.empty.value && columns.count === 0;
        const rests = !store.busy.value && !store.progress.value.live;
        if (!rests || none === boxShown) return;
        boxShown = none;
        queueMicrotask(() => {
          look.show();
          this.fit();
        });
      }),
    ];
  }

  /** The formula was changed or a link read. */
  written() {
    this.writtenMs = performance.now();
  }

  /** The camera does not come for what was written so far. */
  hold() {
    clearTimeout(this.timer);
  }

  come() {
    if (!this.rests()) return;
    this.writtenMs = NaN;
    this.fit();
  }

  fit() {
    if (this.viewer.camera.state.fit) this.viewer.fit();
  }

  /** Also where the last word was a mistake, or has no surface: what stays may be a surface typed on the way to it. */
  rests() {
    const { busy, report, empty } = this.store;
    return !busy.value && (report.value !== null || empty.value);
  }

  close() {
    this.hold();
    for (const stop of this.effects) stop();
  }
}
