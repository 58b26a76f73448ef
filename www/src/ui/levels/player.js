/** Moves along the timeline, by hand or by playback. The place is part of the state. */
import { effect, signal } from '@preact/signals-core';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Levels, To } from './types.js'
 */

export class Player {
  #timer = 0;

  /** @param {Engine} engine @param {Levels} levels */
  constructor(engine, levels) {
    this.levels = levels;
    this.playing = signal(false);
    this.speed = 1;
    // Playback ends when a run begins or ends.
    effect(() => {
      void engine.status.value;
      this.#pause();
    });
  }

  /** Shows a level or a relaxation step at the user's request. @param {number} at  a place of the levels */
  seek(at) {
    this.#pause();
    if (this.levels.some.peek()) this.levels.show(at);
  }

  /** @param {To} to */
  move(to) {
    if (typeof to === 'string') return this.seek(to === 'first' ? 0 : this.levels.last.peek());
    this.#pause();
    this.#go(to);
  }

  /** @param {1 | -1} by @returns whether there was a place to go to */
  #go(by) {
    return this.levels.some.peek() && this.levels.go(by);
  }

  toggle() {
    if (this.playing.peek()) this.#pause();
    else this.#play();
  }

  #play() {
    const { some, at, last, show } = this.levels;
    if (!some.peek()) return;
    if (at.peek() >= last.peek()) show(0);
    this.playing.value = true;
    this.#wait();
  }

  #pause() {
    clearTimeout(this.#timer);
    this.playing.value = false;
  }

  #wait() {
    const { at, last, perSecond } = this.levels;
    const next = () => {
      if (this.#go(1) && at.peek() < last.peek()) this.#wait();
      else this.#pause();
    };
    this.#timer = window.setTimeout(next, 1000 / (perSecond * this.speed));
  }
}
