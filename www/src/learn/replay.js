/**
 * The replay of a race: both pictures and the scorecard at the same cost, on an axis of evaluations, of pushes or of
 * seconds, from snapshots that were kept of both lanes.
 */
import { signal } from '@preact/signals-core';
import { h } from '../ui/dom.js';
import { formatCount, formatSeconds } from '../ui/format.js';
import { shotAt } from './measure.js';
import { createPlay, createRange, createSelect } from './parts.js';
import { scoreOf } from './score.js';
import { createScorecard } from './scorecard.js';

/**
 * @import { Lane } from '../engine/lesson/types.js'
 * @import { Lab, ReplayOptions, Snapshot } from './types.js'
 */

/** So many snapshots of a lane are kept; where there are more, every second one goes. */
export const MOST_SHOTS = 160;
/** The axis has so many places. */
const PLACES = 200;
const REPLAY_MS = 6000;
const SPEEDS = [
  { value: '1', label: 'normal' },
  { value: '0.25', label: 'slow motion' },
];

/**
 * What can be counted.
 * @type {readonly { value: string, label: string, of: (lane: Lane) => number, say: (cost: number) => string }[]}
 */
const COSTS = [
  {
    value: 'evaluations',
    label: 'evaluations of f',
    of: ({ progress }) => progress?.evaluations ?? 0,
    say: (cost) => formatCount(Math.round(cost)),
  },
  {
    value: 'pushes',
    label: 'pushes',
    of: ({ progress }) => progress?.interactions ?? 0,
    say: (cost) => formatCount(Math.round(cost)),
  },
  { value: 'seconds', label: 'seconds', of: ({ workMs }) => workMs / 1000, say: formatSeconds },
];

/** @param {Lab} lab @param {ReplayOptions} about */
export function createReplay(lab, { films, names, isAdaptive, show, point }) {
  const axis = signal(COSTS[0]);
  const most = () => Math.max(...films.map((shots) => axis.value.of(shots[shots.length - 1].lane)));
  const scorecard = createScorecard(point);
  /** What waits to be measured. @type {readonly Snapshot[] | null} */
  let wanted = null;
  let isBusy = false;
  /** Measures the newest that is wanted, one after the other. */
  async function score() {
    if (isBusy) return;
    isBusy = true;
    try {
      while (wanted) {
        const pair = wanted;
        wanted = null;
        const scores = [];
        for (const { lane, particles } of pair)
          scores.push(await scoreOf(lab, particles, { evaluations: lane.progress?.evaluations ?? 0, isAdaptive }));
        if (!wanted) scorecard.tell(names, scores);
      }
    } finally {
      isBusy = false;
    }
  }
  async function seek() {
    // In this order, so that at the end it is no less than the most.
    const cost = most() * (range.get() / PLACES);
    const pair = films.map((shots) => shotAt(shots, axis.peek().of, cost));
    for (const [k, shot] of pair.entries()) show(k, shot);
    wanted = pair;
    await score();
  }
  const range = createRange({
    name: 'Spent',
    max: PLACES,
    value: PLACES,
    say: (at) => axis.value.say(most() * (at / PLACES)),
    change: () => void seek(),
  });
  let speed = 1;
  const play = createPlay(range, { label: 'Replay', totalMs: () => REPLAY_MS / speed });
  const what = createSelect({
    name: 'Both at the same',
    choices: COSTS,
    change: (value) => {
      axis.value = COSTS.find((cost) => cost.value === value) ?? COSTS[0];
      void seek();
    },
  });
  const pace = createSelect({
    name: 'Speed',
    choices: SPEEDS,
    change: (value) => {
      speed = Number(value);
    },
  });
  const controls = h('div', { class: 'controls' }, play.element, range.element, what.element, pace.element);
  return { element: h('div', { class: 'replay' }, controls, scorecard.element), seek };
}
