/**
 * Records the undo history: the last hundred changes of surface, formula, parameters, clip box, cutting plane and
 * settings. Continuous typing or dragging counts as one change. The browser's history is not used, so Back leaves the
 * page as usual.
 */
import { effect, signal } from '@preact/signals-core';

/** @import { Engine, ReadonlySignal, Shape, State } from '../engine/types.js' */

export const MOST_ENTRIES = 100;
/** Largest pause between changes of the same value that are recorded as one. */
const PAUSE_MS = 800;

/** @param {State} state @returns {Shape} */
export const shapeOf = ({ surface, formula, parameters, declared, centres, bounds, plane, settings }) => ({
  surface,
  formula,
  parameters,
  declared,
  centres,
  bounds,
  plane,
  settings,
});

/**
 * Returns the only value in which two states differ, such as `formula` or `settings.count`; null if several differ.
 * @param {Shape} before
 * @param {Shape} after
 */
export function difference(before, after) {
  /** @type {string[]} */
  const found = [];
  for (const key of /** @type {const} */ (['surface', 'formula', 'declared', 'centres', 'bounds', 'plane'])) {
    if (JSON.stringify(before[key]) !== JSON.stringify(after[key])) found.push(key);
  }
  for (const key of /** @type {const} */ (['parameters', 'settings'])) {
    const [a, b] = [before[key], after[key]];
    for (const name of new Set([...Object.keys(a), ...Object.keys(b)]))
      if (a[name] !== b[name]) found.push(`${key}.${name}`);
  }
  return found.length === 1 ? found[0] : null;
}

/** The undo entries and the present position among them. */
export class History {
  #most;
  #at;

  /**
   * Name of the value that the newest entry changed, while further changes of it are merged.
   * @type {string | null}
   */
  #open;
  #lastMs;

  /** @param {number} [most] */
  constructor(most = MOST_ENTRIES) {
    this.#most = most;
    /** @type {Shape[]} */
    this.entries = [];
    this.#at = -1;
    this.#open = null;
    this.#lastMs = 0;
  }

  get canUndo() {
    return this.#at > 0;
  }

  get canRedo() {
    return this.#at < this.entries.length - 1;
  }

  /**
   * @param {Shape} shape
   * @param {number} nowMs
   * @param {boolean} [faulty] whether the previous entry has an invalid formula, which is not worth restoring
   */
  record(shape, nowMs, faulty = false) {
    const present = this.entries[this.#at];
    if (present && JSON.stringify(present) === JSON.stringify(shape)) return;
    const what = present ? difference(present, shape) : null;
    const goesOn =
      what !== null && what === this.#open && (nowMs - this.#lastMs < PAUSE_MS || (faulty && what === 'formula'));
    this.#lastMs = nowMs;
    this.#open = what;
    this.entries.length = this.#at + 1;
    if (goesOn) this.entries[this.#at] = shape;
    else this.entries.push(shape);
    if (this.entries.length > this.#most + 1) this.entries.shift();
    this.#at = this.entries.length - 1;
  }

  /** @param {-1 | 1} step @returns the entry to restore */
  move(step) {
    const entry = this.entries[this.#at + step];
    if (!entry) return null;
    this.#at += step;
    this.#open = null;
    return entry;
  }
}

/**
 * Records the changes of the engine's state.
 * @param {Engine} engine
 * @param {ReadonlySignal<boolean>} moves  whether values change by themselves, which is recorded
 *   once it has ended
 */
export function createHistory(engine, moves) {
  const history = new History();
  const canUndo = signal(false);
  const canRedo = signal(false);
  const tell = () => {
    canUndo.value = history.canUndo;
    canRedo.value = history.canRedo;
  };
  effect(() => {
    const state = engine.state.value;
    if (moves.value) return;
    // Before the core has loaded there is no state to restore.
    if (!engine.description.value || state.surface === '') return;
    history.record(shapeOf(state), performance.now(), engine.fieldError.peek() !== null);
    tell();
  });
  /** @param {-1 | 1} step */
  const move = (step) => {
    const entry = history.move(step);
    if (entry) engine.restore(entry);
    tell();
  };
  return { canUndo, canRedo, undo: () => move(-1), redo: () => move(1) };
}
