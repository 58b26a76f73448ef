/** Creates a native range input of integers from 0. */
import { h, live } from './dom.js';

/** @import { RangeOptions } from './types.js' */

/** @param {RangeOptions} options */
export function createRange({ max, at, say, change, look = 'slider', ...props }) {
  const range = h('input', {
    type: 'range',
    class: look,
    min: 0,
    step: 1,
    'aria-valuetext': say,
    style: { '--place': () => (max() > 0 ? Math.min(1, at() / max()).toFixed(4) : 0) },
    on: {
      input() {
        change(range.valueAsNumber);
        // A refused change is undone.
        range.valueAsNumber = at();
      },
    },
    ...props,
  });
  // The maximum is set before the value, which it limits.
  live(range, () => {
    range.max = String(max());
    range.valueAsNumber = at();
  });
  return range;
}
