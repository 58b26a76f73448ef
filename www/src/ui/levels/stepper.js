/**
 * Steps through the generation levels, manually and by playback. The level is part of the state; the viewer draws it.
 */
import { computed, effect, signal } from '@preact/signals-core';
import { levelTable } from './table.js';
import { turnToSeed } from './turn.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

export class Stepper {
  /** @param {Engine} engine @param {() => number} perSecond  levels per second during playback */
  constructor(engine, perSecond) {
    this.engine = engine;
    this.perSecond = perSecond;
    this.table = signal(levelTable(engine.columns));
    /** The newest visible level, null while all are shown. */
    this.chosen = computed(() => engine.state.value.view.level);
    /** Whether there are levels. */
    this.some = computed(() => this.table.value.count > 0 && !engine.empty.value);
    /** The newest level that is drawn. */
    this.at = computed(() => Math.min(this.chosen.value ?? Infinity, this.table.value.last));
    this.playing = signal(false);
    this.timer = 0;
    // The table is computed at most once per frame, however many column messages a run sends.
    let asked = false;
    effect(() => {
      void engine.revision.value;
      if (asked) return;
      asked = true;
      requestAnimationFrame(() => {
        asked = false;
        this.table.value = levelTable(engine.columns);
      });
    });
  }

  get last() {
    return this.table.peek().last;
  }

  /** @param {number | null} level */
  show(level) {
    const before = this.chosen.peek();
    if (level === before) return;
    if (before === null) turnToSeed(this.engine);
    this.engine.setView({ level });
  }

  /** Shows a level at the user's request and stops the playback. @param {number | null} level */
  seek(level) {
    this.pause();
    if (this.some.peek()) this.show(level);
  }

  /** @param {1 | -1} by */
  step(by) {
    const to = this.at.peek() + by;
    // While all levels are shown, a step back shows the last level; a step forward from that shows all.
    if (this.chosen.peek() === null) this.seek(by < 0 ? this.last : null);
    else this.seek(to > this.last ? null : Math.max(0, to));
  }

  toggle() {
    if (this.playing.peek()) this.pause();
    else this.play();
  }

  play() {
    if (!this.some.peek()) return;
    if (this.chosen.peek() === null || this.at.peek() >= this.last) this.show(0);
    this.playing.value = true;
    this.wait();
  }

  pause() {
    clearTimeout(this.timer);
    this.playing.value = false;
  }

  wait() {
    this.timer = window.setTimeout(() => this.next(), 1000 / this.perSecond());
  }

  next() {
    const level = this.chosen.peek();
    // Another run may have started meanwhile. After the last level, all levels are shown.
    if (level === null || level >= this.last) {
      this.show(null);
      this.pause();
      return;
    }
    this.show(level + 1);
    this.wait();
  }
}
