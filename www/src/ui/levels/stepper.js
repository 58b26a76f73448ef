/**
 * Stepping through the generation levels, by hand and by itself. The level is part of the state; what is drawn of it is the
 * picture's affair.
 */
import { computed, effect, signal } from '@preact/signals-core';
import { levelTable } from './table.js';
import { turnToSeed } from './turn.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

export class Stepper {
  /** @param {Engine} engine @param {() => number} perSecond  levels per second while it goes by itself */
  constructor(engine, perSecond) {
    this.engine = engine;
    this.perSecond = perSecond;
    this.table = signal(levelTable(engine.columns));
    /** The newest level to be seen, null while all are shown. */
    this.chosen = computed(() => engine.state.value.view.level);
    /** Whether there is any level. */
    this.some = computed(() => this.table.value.count > 0 && !engine.empty.value);
    /** The newest level that is drawn. */
    this.at = computed(() => Math.min(this.chosen.value ?? Infinity, this.table.value.last));
    this.playing = signal(false);
    this.timer = 0;
    // However many pieces a run comes in, the table is made once a frame.
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

  /** Goes to a level by hand. @param {number | null} level */
  seek(level) {
    this.pause();
    if (this.some.peek()) this.show(level);
  }

  /** @param {1 | -1} by */
  step(by) {
    const to = this.at.peek() + by;
    // From the whole picture a step back leads to the last level, a step forward from that to the whole picture.
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
    // Another run may have begun meanwhile; after the last level all of them are shown alike.
    if (level === null || level >= this.last) {
      this.show(null);
      this.pause();
      return;
    }
    this.show(level + 1);
    this.wait();
  }
}
