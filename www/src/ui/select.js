/** Creates a menu of choices. */
import { fill, h, live } from './dom.js';

/** @import { SelectOptions } from './types.js' */

/**
 * Creates a select. It shows the choice given by `value`; without `value` it keeps the user's choice.
 * @template {string | number} T
 * @param {SelectOptions<T>} options
 */
export function createSelect({ name, choices, value, change, look = '' }) {
  /** @type {Exclude<typeof choices, Function>} */
  let shown = [];
  const select = h('select', {
    class: `select ${look}`.trim(),
    'aria-label': name,
    on: { change: () => change?.(shown[select.selectedIndex].value) },
  });
  live(select, () => {
    const next = typeof choices === 'function' ? choices() : choices;
    const wanted = value ? String(value()) : select.value;
    if (next !== shown) {
      shown = next;
      fill(
        select,
        next.map((choice) => h('option', { value: choice.value }, choice.label)),
      );
    }
    if (next.some((choice) => String(choice.value) === wanted)) select.value = wanted;
  });
  return select;
}
