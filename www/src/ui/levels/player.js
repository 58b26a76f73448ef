/**
 * Moves along the timeline: by levels, by particles or by events, manually and by playback. Where it stands is part of
 * the state.
 */
import { computed, effect, signal } from '@preact/signals-core';

/**
 * @import { Engine, Grain, ReadonlySignal, Signal } from '../../engine/types.js'
 * @import { FollowPanel, Track } from '../types.js'
 * @import { Levels, Move } from './types.js'
 */

export class Player {
  #load;
  #timer;

  /**
   * @param {Engine} engine
   * @param {Levels} levels
   * @param {() => Promise<FollowPanel | null>} load  loads the panel that follows a particle; null if it cannot be had
   */
  constructor(engine, levels, load) {
    this.engine = engine;
    this.levels = levels;
    this.#load = load;
    /** @type {Signal<FollowPanel | null>} */
    this.panel = signal(null);
    this.isOpen = computed(() => this.panel.value?.open.value ?? false);
    /** @type {ReadonlySignal<Grain>} */
    this.grain = computed(() => (this.isOpen.value ? engine.state.value.view.grain : 'level'));
    this.track = computed(() => this.#trackOf(this.grain.value));
    this.playing = signal(false);
    this.speed = 1;
    this.#timer = 0;
    // Playback ends where the grain changes or a run begins or ends.
    effect(() => {
      void this.grain.value;
      void engine.busy.value;
      this.#pause();
    });
  }

  /** @param {Grain} grain */
  #trackOf(grain) {
    const panel = this.panel.value;
    if (!panel || grain === 'level') return this.levels;
    return grain === 'particle' ? panel.particles : panel.events;
  }

  /** Loads the panel that follows a particle, which is then part of the timeline. */
  async prepare() {
    this.panel.value ??= await this.#load();
    return this.panel.value;
  }

  /** Chooses a grain. The finer ones open a particle: the first of the level that is shown. @param {Grain} grain */
  async choose(grain) {
    if (grain === this.grain.peek()) return;
    this.#pause();
    const { engine, levels } = this;
    if (grain === 'level') {
      const level = this.panel.peek()?.level.peek() ?? null;
      return engine.setView({ grain, level, step: null });
    }
    const panel = await this.prepare();
    if (!panel) return;
    const first = firstOf(engine, levels.level.peek());
    if (!panel.open.peek()) panel.follow(first);
    else if (this.grain.peek() === 'level' && levels.level.peek() !== null) panel.goToLevel(levels.newest.peek());
    engine.setView({ grain, level: null, step: null });
  }

  /** Follows a particle of the picture. @param {number} index */
  async follow(index) {
    this.#pause();
    (await this.prepare())?.follow(index);
  }

  /** Shows a place of the chosen grain at the user's request. @param {number} at */
  seek(at) {
    this.#pause();
    this.#show(this.track.peek(), at);
  }

  /** @param {Track} track @param {number} at */
  #show(track, at) {
    if (!track.some.peek()) return;
    track.show(at);
    if (track === this.levels) this.#followLevel();
  }

  /** Shows a level or a relaxation step, whatever the timeline goes along. @param {number} at  a place of the levels */
  seekLevel(at) {
    this.#pause();
    if (this.grain.peek() !== 'level') this.engine.setView({ grain: 'level', level: null, step: null });
    this.#show(this.levels, at);
  }

  /** A particle that is followed goes along with the levels. */
  #followLevel() {
    const { newest, level } = this.levels;
    if (this.isOpen.peek() && level.peek() !== null) this.panel.peek()?.goToLevel(newest.peek());
  }

  /** @param {Move} move */
  move({ grain: named, to }) {
    this.#pause();
    const chosen = this.grain.peek();
    const grain = named === 'chosen' ? chosen : named;
    if (grain !== 'level' && !this.isOpen.peek()) return void this.choose(grain);
    const panel = this.panel.peek();
    if (grain === 'level' && chosen !== 'level' && panel) {
      if (typeof to === 'string') return this.seekLevel(to === 'first' ? 0 : this.levels.last.peek());
      // A step by a level among events leads to the first particle of that level.
      const level = panel.level.peek();
      if (level !== null) panel.goToLevel(level + to);
      return;
    }
    const track = this.#trackOf(grain);
    if (to === 'first' || to === 'last') return this.#show(track, to === 'first' ? 0 : track.last.peek());
    this.#go(track, to);
  }

  /** @param {Track} track @param {1 | -1} by @returns whether there was a place to go to */
  #go(track, by) {
    const moved = track.some.peek() && track.go(by);
    if (moved && track === this.levels) this.#followLevel();
    return moved;
  }

  toggle() {
    if (this.playing.peek()) this.#pause();
    else this.#play();
  }

  #play() {
    const track = this.track.peek();
    if (!track.some.peek()) return;
    if (track === this.levels && track.at.peek() >= track.last.peek()) this.#show(track, 0);
    this.playing.value = true;
    this.#wait();
  }

  #pause() {
    clearTimeout(this.#timer);
    this.playing.value = false;
  }

  #wait() {
    const track = this.track.peek();
    const next = () => {
      const goesOn = this.#go(track, 1) && !(track === this.levels && track.at.peek() >= track.last.peek());
      if (goesOn) this.#wait();
      else this.#pause();
    };
    this.#timer = window.setTimeout(next, 1000 / (track.perSecond * this.speed));
  }
}

/**
 * The first particle of a level in the picture, the seed if none is named.
 * @param {Engine} engine
 * @param {number | null} level
 */
function firstOf({ columns }, level) {
  const first =
    level === null ? 0 : columns.levels.subarray(0, columns.count).indexOf(Math.min(level, columns.lastLevel));
  return Math.max(0, first);
}
