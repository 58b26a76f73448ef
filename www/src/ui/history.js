/**
 * Records the undo history: the last hundred changes of surface, formula, parameters, clip box, cutting plane, settings
 * and camera. Typing up to a pause, a drag and a camera motion count as one change each. The browser's history is
 * separate: Back returns to the previous surface (main/address.js).
 */
import { effect, signal } from '@preact/signals-core';
import { MODEL } from '../engine/constants.js';

/**
 * @import { Engine, ReadonlySignal, State } from '../engine/types.js'
 * @import { Moment } from './types.js'
 */

export const MOST_ENTRIES = 100;
/** Longest pause between changes of one value that are merged into one entry. */
const PAUSE_MS = 800;

/** @param {State} state @returns {Moment} */
export const momentOf = ({ v: _, view, ...shape }) => ({ ...shape, camera: view.camera });

/**
 * Returns whether the user has moved the camera. If it follows the surface, target and distance are not the user's.
 * @param {Moment} before @param {Moment} after
 */
function isLookedAround({ camera: a }, { camera: b }) {
  const isTurned = a.yaw !== b.yaw || a.pitch !== b.pitch;
  const isMoved = a.distance !== b.distance || a.target.some((v, k) => v !== b.target[k]);
  return isTurned || a.fit !== b.fit || (isMoved && !b.fit);
}

/**
 * Returns the names of the values that differ between two states, such as `formula` or `settings.count`.
 * @param {Moment} before
 * @param {Moment} after
 */
export function differences(before, after) {
  const found = isLookedAround(before, after) ? ['camera'] : [];
  for (const key of /** @type {const} */ ([
    'surface',
    'formula',
    'declared',
    'centres',
    'bounds',
    'plane',
    'pulls',
    'lines',
  ])) {
    if (JSON.stringify(before[key]) !== JSON.stringify(after[key])) found.push(key);
  }
  for (const key of /** @type {const} */ (['parameters', 'settings'])) {
    const [a, b] = [before[key], after[key]];
    for (const name of new Set([...Object.keys(a), ...Object.keys(b)]))
      if (a[name] !== b[name]) found.push(`${key}.${name}`);
  }
  return found;
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
    /** @type {Moment[]} */
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
   * @param {Moment} moment
   * @param {number} nowMs
   * @param {{ faulty?: boolean, isWritten?: boolean, isTurned?: boolean }} [how]  `faulty`: the previous entry has an
   *   invalid formula, so that it is not worth restoring; `isWritten`: somebody has written the
   *   formula, with which no surface begins; `isTurned`: the page has turned the camera for that surface
   */
  record(moment, nowMs, { faulty = false, isWritten = false, isTurned = false } = {}) {
    const present = this.entries[this.#at];
    const found = present && differences(present, moment);
    if (found?.length === 0 || (isTurned && found?.length === 1 && found[0] === 'camera')) {
      // The camera has only followed the surface.
      this.entries[this.#at] = moment;
      return;
    }
    // A formula written for or instead of a model from points changes the surface along with it.
    const isFormula = isWritten && found?.includes('formula') && found.includes('surface');
    const what = isFormula ? 'formula' : found?.length === 1 ? found[0] : null;
    const goesOn =
      what !== null &&
      what === this.#open &&
      // A stroke of the brush and a marked edge are one change each, however soon the next follows.
      what !== 'settings.brush' &&
      what !== 'lines' &&
      // A camera motion is one change, however long it takes; fitting the surface again is another.
      (what === 'camera'
        ? present?.camera.fit === moment.camera.fit
        : nowMs - this.#lastMs < PAUSE_MS || (faulty && what === 'formula'));
    this.#lastMs = nowMs;
    this.#open = what;
    this.entries.length = this.#at + 1;
    if (goesOn) this.entries[this.#at] = moment;
    else this.entries.push(moment);
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
  /** `engine.turned` when the state got its present camera. */
  let turned = engine.turned.peek();
  let { camera } = engine.state.peek().view;
  const canUndo = signal(false);
  const canRedo = signal(false);
  const record = (/** @type {State} */ state) => {
    // Before the core has loaded there is no state to restore.
    if (!engine.description.value || state.surface === '') return;
    const own = engine.description.value.surfaces.find(({ id }) => id === state.surface)?.formula ?? MODEL;
    const [last, now] = [turned, engine.turned.peek()];
    // The state gets the new camera once the picture stands still.
    if (state.view.camera !== camera) [turned, camera] = [now, state.view.camera];
    const how = {
      faulty: engine.fieldError.peek() !== null,
      isWritten: state.formula !== own,
      isTurned: last !== now,
    };
    history.record(momentOf(state), performance.now(), how);
  };
  const tell = () => {
    canUndo.value = history.canUndo;
    canRedo.value = history.canRedo;
  };
  effect(() => {
    const state = engine.state.value;
    if (moves.value) return;
    record(state);
    tell();
  });
  /** @param {-1 | 1} step */
  const move = (step) => {
    // A change in progress is recorded first, so that redo leads back to it.
    record(engine.state.peek());
    const entry = history.move(step);
    if (entry) engine.restore(entry);
    tell();
  };
  return { canUndo, canRedo, undo: () => move(-1), redo: () => move(1) };
}
