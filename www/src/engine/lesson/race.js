/**
 * Two methods side by side on one surface, each in a worker of its own.
 *
 * They work in turn: always the one whose clock is behind, so that no one takes time from the other and both have
 * worked equally long at every moment, until one is done. Each ends by its own rules.
 *
 * ```js
 * const race = new Race({ onLane: (k, lane) => show(k, lane.workMs, lane.progress) });
 * const ours = { radius: 0.05 };
 * await race.start({ formula, parameters, bounds }, [ours, opponentOf(ours)]);
 * const { positions, normals, radii } = await race.particles(1);
 * ```
 *
 * @module
 */
import { nextBudget } from '../bundle/budget.js';
import { LessonClient, LessonError, spawnLesson } from './client.js';

/** @import { Lane, LessonSettings, RaceOptions, Surface } from './types.js' */

/** Target duration of a turn. */
const TURN_MS = 12;
const FIRST_UNITS = 64;

/**
 * The settings of the method that the paper compares this one with (Table 1), for the same sizes.
 * @param {Partial<LessonSettings>} settings
 * @returns {Partial<LessonSettings>}
 */
export const opponentOf = (settings) => ({
  ...settings,
  method: settings.sampling === 'adaptive' ? 'forces' : 'witkin_heckbert',
  // The largest size of an adaptive particle; in Witkin and Heckbert's system, 0 leaves it to the surface.
  radius_max: settings.sampling === 'adaptive' ? settings.radius_max : 0,
});

export class Race {
  #onLane;
  #clients;

  /** Number of the present race. */
  #race;

  /** Fulfilled while the race is not paused. @type {Promise<void>} */
  #gate;
  #open;

  /** @param {RaceOptions} [options] */
  constructor({ spawn = spawnLesson, onLane = () => {} } = {}) {
    this.#onLane = onLane;
    this.#clients = [new LessonClient({ spawn }), new LessonClient({ spawn })];
    /** @type {[Lane, Lane]} */
    this.lanes = [newLane(), newLane()];
    this.#race = 0;
    this.#gate = Promise.resolve();
    this.#open = () => {};
  }

  /**
   * Begins a race and goes to its end. The race before is given up: its promise is rejected with a `LessonError`, as it
   * is if a surface or a setting is refused.
   * @param {Surface} surface @param {[Partial<LessonSettings>, Partial<LessonSettings>]} settings
   */
  async start(surface, settings) {
    this.resume();
    this.#race += 1;
    const race = this.#race;
    /** @type {[Lane, Lane]} */
    const lanes = [newLane(), newLane()];
    this.lanes = lanes;
    const begun = await Promise.all(this.#clients.map((client, k) => client.start(surface, settings[k], true)));
    const units = [FIRST_UNITS, FIRST_UNITS];
    for (const [k, lane] of lanes.entries()) lane.progress = begun[k];
    for (;;) {
      await this.#gate;
      if (race !== this.#race) throw new LessonError('given_up', 'another race has begun');
      const k = nextOf(lanes);
      if (k === null) return;
      const { progress, workMs } = await this.#clients[k].ask('advance', { units: units[k] });
      units[k] = nextBudget(units[k], workMs, TURN_MS);
      lanes[k].progress = progress;
      lanes[k].workMs += workMs;
      this.#onLane(k, lanes[k]);
    }
  }

  /** No turn begins until `resume`. */
  pause() {
    this.resume();
    this.#gate = new Promise((resolve) => {
      this.#open = resolve;
    });
  }

  resume() {
    this.#open();
    this.#gate = Promise.resolve();
  }

  /** The particles of one of the two, as they are now. @param {0 | 1} index */
  particles(index) {
    return this.#clients[index].ask('seek', { event: Infinity });
  }

  /** Gives the race up and frees both workers. */
  close() {
    this.#race += 1;
    this.resume();
    for (const client of this.#clients) client.close();
  }
}

/** @returns {Lane} */
const newLane = () => ({ progress: null, workMs: 0 });

/** The one that is not done and has worked less. @param {[Lane, Lane]} lanes */
function nextOf(lanes) {
  const [first, second] = lanes.map((lane) => (lane.progress?.is_done ? Infinity : lane.workMs));
  if (Math.min(first, second) === Infinity) return null;
  return first <= second ? 0 : 1;
}
