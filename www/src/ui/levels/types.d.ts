// Types of the timeline, its levels and its charts.

import type { Signal } from '@preact/signals-core';
import type { Pattern } from '../../engine/types.js';
import type { Drawn } from '../types.js';
import type { createLevels } from './levels.js';
import type { createTimeline } from './timeline.js';

export type { Player } from './player.js';
/** `value`: of the place that is shown, or of all; `label`: the chart in words; `missing`: why nothing is known. */
export type Chart = Drawn & { title: string; value: string; label: string; missing?: string };
/** Where a move leads: to the place before or after, or to the first or last one. */
export type To = -1 | 1 | 'first' | 'last';
export type Levels = ReturnType<typeof createLevels>;
/**
 * The table has one row per level. `fates` has eight counts per level: the fates of the children that the previous
 * level proposed.
 */
export interface LevelTable {
  /** particles in all */
  count: number;
  /** number of the last level */
  last: number;
  /** particles of each level */
  fresh: Uint32Array;
  /** particles of all levels up to each one */
  total: Uint32Array;
  /** particles of each level without a parent */
  seeds: Uint32Array;
  fates: Uint32Array;
  adaptive: boolean;
  /** in a pattern that is drawn, levels are rounds, without children */
  pattern: Pattern;
  /** the kinds of curves from which the fronts start, where patches meet */
  curves: string[];
}
export type Told = { title: string; text: string };
export type Timeline = ReturnType<typeof createTimeline>;
export interface TimelineOptions {
  /** the level in words, null while all are shown */
  told: Signal<Told | null>;
  /** tells what a link names and is not there */
  say: (text: string) => void;
}
