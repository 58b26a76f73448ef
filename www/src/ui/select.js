/** Creates a menu of choices. */
import { h } from './dom.js';

/** @import { SelectOptions } from './types.js' */

/**
 * @template {string | number} T
 * @param {SelectOptions<T>} options
 */
export const createSelect = ({ name, choices, value, change, look = '' }) =>
  h(
    'select',
    {
      class: `select ${look}`.trim(),
      'aria-label': name,
      prop: { value: () => String(value()) },
      on: { change: ({ currentTarget }) => change(choices[currentTarget.selectedIndex].value) },
    },
    choices.map(({ value, label }) => h('option', { value }, label)),
  );
