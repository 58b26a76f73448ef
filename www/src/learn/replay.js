/**
 * A replay: two pictures and the scorecard at the same place of an axis, from snapshots that were kept of two lanes.
 * These may still be under way.
 */
import { signal } from '@preact/signals-core';
import { h } from '../ui/dom.js';
import { latest } from './latest.js';
import { shotAt } from './measure.js';
import { createPlay, createRangeRow, createSelectRow } from './parts.js';
import { createScorecard } from './scorecard.js';

/** @import { ReplayOptions, Snapshot } from './types.js' */

/** So many snapshots of a lane are kept; where there are more, every second one goes. */
export const MOST_SHOTS = 160;
const REPLAY_MS = 6000;
const SPEEDS = [
  { value: '1', label: 'normal' },
  { value: '0.25', label: 'slow motion' },
];

/** @template L @param {ReplayOptions<L>} about */
export function createReplay({ films, names, axes, axisName, name, places, at, most, score, show, point }) {
  const axis = signal(axes[0]);
  const costAt = (/** @type {number} */ place) => most(axis.value.of) * (place / places);
  const scorecard = createScorecard(point);
  const measure = latest(
    async (/** @type {{ pair: readonly Snapshot<L>[], caption: string }} */ { pair, caption }, isOld) => {
      const scores = [];
      for (const shot of pair) scores.push(await score(shot));
      // While it plays there is always a newer moment; the caption says which one this is.
      scorecard.tell(names, scores, { caption });
      if (isOld()) scorecard.wait();
    },
  );
  async function seek() {
    // In this order, so that at the end it is no less than the most.
    const cost = costAt(range.get());
    const pair = films.map((shots) => shotAt(shots, axis.peek().of, cost));
    for (const [k, shot] of pair.entries()) show(k, shot);
    scorecard.wait();
    await measure({ pair, caption: axis.peek().moment(cost) });
  }
  const range = createRangeRow({
    name,
    max: places,
    value: at,
    say: (place) => axis.value.say(costAt(place)),
    change: () => void seek(),
  });
  let speed = 1;
  const play = createPlay(range, { label: 'Replay', totalMs: () => REPLAY_MS / speed });
  const what = createSelectRow({
    name: axisName,
    choices: axes,
    change: (value) => {
      axis.value = axes.find((one) => one.value === value) ?? axes[0];
      void seek();
    },
  });
  const pace = createSelectRow({
    name: 'Speed',
    choices: SPEEDS,
    change: (value) => {
      speed = Number(value);
    },
  });
  const controls = h(
    'div',
    { class: 'controls' },
    play.element,
    range.element,
    axes.length > 1 ? what.element : null,
    pace.element,
  );
  return { element: h('div', { class: 'replay' }, controls, scorecard.element), controls, scorecard, range, seek };
}
