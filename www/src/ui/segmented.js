/** Creates a segmented control: two or three radio buttons side by side. */
import { h, live, uniqueId } from './dom.js';

/** @import { SegmentedOptions } from './types.js' */

/**
 * @template {string} T
 * @param {SegmentedOptions<T>} options
 */
export function createSegmented({ name, choices, value: checked, disabled, change }) {
  const group = uniqueId('segmented');
  const inputs = choices.map(({ value }) =>
    h('input', {
      type: 'radio',
      name: group,
      value,
      disabled,
      on: { change: () => void Promise.resolve(change(value)).then(check) },
    }),
  );
  // A refused choice is undone.
  const check = () => {
    for (const input of inputs) input.checked = input.value === checked();
  };
  const element = h(
    'div',
    { class: 'segmented', role: 'radiogroup', 'aria-label': name },
    choices.map(({ label }, i) => h('label', { class: 'segment' }, inputs[i], h('span', null, label))),
  );
  live(element, check);
  return element;
}
