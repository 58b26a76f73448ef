/**
 * Animates what the user otherwise drags: one parameter between the ends of its slider, and the turn of the surface.
 */
import { signal } from '@preact/signals-core';
import { snap } from './scale.js';

/**
 * @import { Engine, Signal } from '../engine/types.js'
 * @import { Course, Range } from './types.js'
 */

/** Seconds in which a parameter crosses its range, and the turntable makes one turn, at the usual speed. */
export const CROSSING_S = 6;
export const TURN_S = 12;
/** Longest time step, so that nothing jumps after a pause of the page. */
const LONGEST_STEP_S = 0.1;

/**
 * Returns the place in the range, 0 to 1, after a number of crossings.
 * @param {number} crossings
 * @param {Course} course
 */
export function placeAt(crossings, course) {
  const rest = crossings - Math.floor(crossings);
  if (course === 'loop') return rest;
  return Math.floor(crossings) % 2 === 0 ? rest : 1 - rest;
}

/** Returns the value at a place in the range. @param {Range} range @param {number} place */
export const valueAt = ({ min, max, step }, place) => snap({ min, max, step }, min + place * (max - min));

/** @param {Engine} engine @param {HTMLElement} stage  a press on it ends the turning */
export function createMotion(engine, stage) {
  /** @type {Signal<string | null>} */
  const playing = signal(null);
  const turning = signal(false);
  const filming = signal(false);
  /** @type {Signal<Course>} */
  const course = signal('bounce');
  const speed = signal(1);
  let player = /** @type {Player | null} */ (null);
  let lastMs = 0;
  let frame = 0;

  /** @param {number} nowMs */
  function step(nowMs) {
    const passedS = Math.min(Math.max(0, nowMs - lastMs) / 1000, LONGEST_STEP_S) * speed.peek();
    lastMs = nowMs;
    if (turning.peek()) engine.orbit((2 * Math.PI * passedS) / TURN_S, 0);
    if (player && !player.step(passedS, course.peek())) drop();
    frame = player || turning.peek() ? requestAnimationFrame(step) : 0;
  }
  function start() {
    if (frame !== 0) return;
    lastMs = performance.now();
    frame = requestAnimationFrame(step);
  }
  function drop() {
    player = null;
    playing.value = null;
  }
  /** Ends all motion. @returns whether there was any */
  const stop = () => {
    const ended = player;
    const moved = ended !== null || turning.peek();
    drop();
    turning.value = false;
    ended?.rest();
    return moved;
  };
  stage.addEventListener('pointerdown', () => {
    turning.value = false;
  });
  return {
    /** Name of the animated parameter. */
    playing,
    turning,
    /** Whether a film is being made. It moves parameters and the camera. */
    filming,
    course,
    speed,
    stop,
    /** Starts or stops the motion of a parameter. @param {Range} range */
    toggle(range) {
      const wasPlaying = playing.peek();
      player?.rest();
      drop();
      if (wasPlaying === range.name) return;
      player = new Player(engine, range);
      playing.value = range.name;
      start();
    },
    toggleTurning() {
      turning.value = !turning.peek();
      if (turning.peek()) start();
    },
  };
}

/** An animated parameter. */
class Player {
  /** The value set last. */
  #value;
  #crossings;

  /** @param {Engine} engine @param {Range} range */
  constructor(engine, range) {
    this.engine = engine;
    this.range = range;
    this.#value = this.#present();
    const place = (this.#value - range.min) / (range.max - range.min);
    this.#crossings = Math.min(1, Math.max(0, place));
  }

  /** Returns the parameter's value on the page; NaN if the formula no longer has it. */
  #present() {
    const { engine, range } = this;
    const parameter = engine.field.peek()?.parameters.find(({ name }) => name === range.name);
    return parameter ? (engine.state.peek().parameters[range.name] ?? parameter.value) : Number.NaN;
  }

  /**
   * Advances by some seconds.
   * @param {number} passedS @param {Course} course
   * @returns false if something else has set the parameter, or the formula no longer has it
   */
  step(passedS, course) {
    if (this.#present() !== this.#value) return false;
    this.#crossings += passedS / CROSSING_S;
    // It waits for a run longer than a frame, which would otherwise be replaced before any of it is seen.
    if (this.engine.status.peek() === 'sampling') return true;
    const value = valueAt(this.range, placeAt(this.#crossings, course));
    if (value !== this.#value) {
      this.#value = value;
      this.engine.setParameter(this.range.name, value, { live: true });
    }
    return true;
  }

  /** Ends with a run at full quality. */
  rest() {
    if (this.#present() === this.#value) this.engine.setParameter(this.range.name, this.#value);
  }
}
