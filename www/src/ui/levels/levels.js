/**
 * The places of the timeline: the generation levels, then the relaxation steps, then the present particles. The place
 * is part of the state; the viewer draws it.
 */
import { computed, effect, signal } from '@preact/signals-core';
import { formatCount, plural } from '../format.js';
import { levelTable, shortOf } from './table.js';

/**
 * @import { Angles, Columns, Engine } from '../../engine/types.js'
 * @import { Track } from '../types.js'
 */

/** Height of a relaxation step's bar while its moves are unknown, as a share of the highest level. */
const STEP_HEIGHT = 0.12;

/**
 * Returns the number of places after the levels: the relaxation steps that can be shown, and at least 1.
 * @param {number} kept  positions that were kept, the first as placed
 */
export const stepsOf = (kept) => Math.max(1, kept);

/**
 * Returns what is drawn at a place: a level, a relaxation step, or everything.
 * @param {number} at @param {{ last: number, steps: number }} about  the last level, and the relaxation steps
 * @returns {{ level: number | null, step: number | null }}
 */
export function drawnAt(at, { last, steps }) {
  if (at <= last) return { level: Math.max(0, at), step: null };
  const step = at - last;
  return { level: null, step: step < steps ? step : null };
}

/**
 * Returns the place on the timeline of what is drawn.
 * @param {{ level: number | null, step: number | null }} drawn @param {{ last: number, steps: number }} about
 */
export function trackPlace({ level, step }, { last, steps }) {
  if (level !== null) return Math.min(level, last);
  return step !== null && step < steps ? last + Math.max(1, step) : last + steps;
}

/** Cosine of the angle to the eye above which a particle is visible. */
const SEEN = 0.1;

/**
 * Returns whether every particle up to a level faces away from the camera, so that the faint rest of the surface would
 * hide them all.
 * @param {Pick<Columns, 'count' | 'levels' | 'normals'>} particles
 * @param {Angles} camera @param {number} level
 */
export function isOutOfSight({ count, levels, normals }, { yaw, pitch }, level) {
  const [x, y, z] = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
  for (let i = 0; i < count; i += 1) {
    const facing = x * normals[3 * i] + y * normals[3 * i + 1] + z * normals[3 * i + 2];
    if (levels[i] <= level && facing > SEEN) return false;
  }
  return count > 0;
}

/** @param {Engine} engine */
export function createLevels(engine) {
  const table = signal(levelTable(engine.columns));
  /** Number of positions kept of the relaxation. */
  const kept = signal(engine.columns.past.length);
  watch(engine, () => {
    table.value = levelTable(engine.columns);
    kept.value = engine.columns.past.length;
  });
  const view = computed(() => engine.state.value.view);
  const level = computed(() => view.value.level);
  const step = computed(() => view.value.step);
  const about = computed(() => ({ last: table.value.last, steps: stepsOf(kept.value) }));
  const at = computed(() => trackPlace({ level: level.value, step: step.value }, about.value));
  const last = computed(() => about.value.last + about.value.steps);
  const whole = computed(() => at.value === last.value);
  /** The newest level drawn. */
  const newest = computed(() => Math.min(level.value ?? Infinity, table.value.last));
  /** The relaxation step that is drawn; null if the place is not a single step. */
  const relaxed = computed(() => (whole.value || level.value !== null ? null : at.value - about.value.last));

  /** @param {number} place */
  function show(place) {
    if (!some.peek() || place === at.peek()) return;
    const to = drawnAt(place, about.peek());
    if (to.level !== null) turnTo(to.level, whole.peek());
    engine.setView(to);
  }
  /**
   * Turns the seed towards the eye, on return from the whole run or if nothing of a level would be visible.
   * @param {number} to
   * @param {boolean} [isBack]
   */
  function turnTo(to, isBack = false) {
    const { columns, state } = engine;
    const [x, y, z] = columns.normals;
    if (isBack || isOutOfSight(columns, state.peek().view.camera, to)) engine.turnTo([x, y, z]);
  }
  const some = computed(() => table.value.count > 0 && engine.result.value !== 'none');
  /** @type {Track} */
  const track = {
    name: 'level',
    perSecond: 10,
    some,
    at,
    last,
    whole,
    text: computed(() => {
      const { last: end, steps } = about.value;
      if (whole.value) return `All ${plural(end + 1, 'level')}: ${plural(table.value.count, 'particle')}`;
      if (relaxed.value !== null) return `Relaxation step ${formatCount(relaxed.value)} of ${formatCount(steps)}`;
      return shortOf(table.value, newest.value);
    }),
    short: computed(() => {
      const { last: end, steps } = about.value;
      if (whole.value) return ['All levels', `0 to ${formatCount(end)}`];
      if (relaxed.value !== null) return [`Relaxation ${formatCount(relaxed.value)}`, `of ${formatCount(steps)}`];
      return [`Level ${formatCount(newest.value)}`, `of ${formatCount(end)}`];
    }),
    bars: computed(() => {
      const { fresh } = table.value;
      const most = fresh.reduce((a, b) => Math.max(a, b), 1);
      return { heights: [...fresh, ...new Array(about.value.steps).fill(STEP_HEIGHT * most)] };
    }),
    show,
    go(by) {
      const to = at.peek() + by;
      if (to < 0 || to > last.peek()) return false;
      show(to);
      return true;
    },
  };
  return { ...track, table, kept, level, newest, relaxed, turnTo };
}

/**
 * Calls `act` at most once per frame, however many column messages a run sends.
 * @param {Engine} engine
 * @param {() => void} act
 */
function watch(engine, act) {
  let asked = false;
  effect(() => {
    void engine.revision.value;
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      act();
    });
  });
}
