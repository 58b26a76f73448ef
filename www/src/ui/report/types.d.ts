// Types of the report.

import type { ReadonlySignal } from '@preact/signals-core';
import type { ReportRow } from '../../engine/types.js';

export type Bins = { min: number; max: number; bins: number[] };
export interface TableOptions {
  /** particles of a run without a report yet, or 0 */
  counted: ReadonlySignal<number>;
  /** whether the figures are those of an earlier run, whose particles are gone */
  stale: ReadonlySignal<boolean>;
  /** shows the next place that a figure is about */
  show: (row: ReportRow) => void;
}
