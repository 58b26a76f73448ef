/**
 * The two finer grains of the timeline: the particles of the run, in the order in which they are treated, and the
 * events of one.
 */
import { computed, signal } from '@preact/signals-core';
import { valueText } from '../../figures/words.js';
import { formatCount } from '../format.js';

/**
 * @import { LessonEvent } from '../../engine/types.js'
 * @import { Track } from '../types.js'
 * @import { Follower } from './types.js'
 */

/** A place that stands for itself, not for the whole. */
const never = signal(false);

/**
 * Heights of the bars of the events: what happens to a child stands out, its fate most.
 * @type {Record<string, number>}
 */
const HEIGHTS = { taken: 1, done: 1, fate: 0.8, added: 0.8, slot: 0.55, landed: 0.55, room: 0.55, arc: 0.55 };
const USUAL_HEIGHT = 0.3;

/** @param {readonly LessonEvent[]} events */
export const heightsOf = (events) => events.map(({ type }) => HEIGHTS[type] ?? USUAL_HEIGHT);

/**
 * Returns the stretches of particles of one level, in the order in which they were placed.
 * @param {ArrayLike<number>} levels
 */
export function stretchesOf(levels) {
  /** @type {number[]} */
  const widths = [];
  for (let i = 0; i < levels.length; i += 1) {
    if (i > 0 && levels[i] === levels[i - 1]) widths[widths.length - 1] += 1;
    else widths.push(1);
  }
  return widths;
}

/** @param {Follower} follower @returns {Track} */
export function particleTrack(follower) {
  const { opened, run, target } = follower;
  const last = computed(() => Math.max(0, follower.count - 1));
  /** A particle by itself is shown as it is done, the events of one from the first on. @param {number} at */
  const show = (at) => void follower.open(at, { at: follower.engine.state.peek().view.grain === 'event' ? 0 : 'last' });
  return {
    name: 'particle',
    perSecond: 2,
    some: computed(() => follower.count > 0),
    at: target,
    last,
    whole: never,
    text: textOf(follower),
    short: computed(() => [`Particle ${formatCount(target.value)}`, `of ${formatCount(follower.count)}`]),
    bars: computed(() => {
      const widths = stretchesOf(run.value?.end.levels ?? []);
      return { heights: widths, widths };
    }),
    show,
    go(by) {
      const to = target.peek() + by;
      if (opened.peek() === null || to < 0 || to > last.peek()) return false;
      show(to);
      return true;
    },
  };
}

/** @param {Follower} follower @returns {Track} */
export function eventTrack(follower) {
  const { opened, at, target } = follower;
  const count = computed(() => opened.value?.events.length ?? 0);
  return {
    name: 'event',
    // Long enough to read a sentence.
    perSecond: 0.85,
    some: computed(() => count.value > 0),
    at,
    last: computed(() => Math.max(0, count.value - 1)),
    whole: never,
    text: textOf(follower),
    short: computed(() => [`Event ${formatCount(at.value + 1)}`, `of ${formatCount(count.value)}`]),
    bars: computed(() => ({ heights: heightsOf(opened.value?.events ?? []) })),
    show: (to) => follower.seek(to),
    go(by) {
      // Another particle is being opened.
      if (opened.peek() && opened.peek()?.subject.particle !== target.peek()) return true;
      const to = at.peek() + by;
      if (to >= 0 && to < count.peek()) {
        follower.seek(to);
        return true;
      }
      // The timeline goes on with the particle that is treated next.
      const other = target.peek() + by;
      if (opened.peek() === null || other < 0 || other >= follower.count) return false;
      void follower.open(other, { at: by > 0 ? 0 : 'last' });
      return true;
    },
  };
}

/** @param {Follower} follower */
const textOf = ({ opened, moment }) =>
  computed(() => {
    if (!opened.value) return 'No particle is open';
    const { subject } = opened.value;
    return moment.value
      ? valueText(moment.value, subject)
      : `Level ${formatCount(subject.level)}, particle ${formatCount(subject.particle)}: no events`;
  });
