/** Creates a segmented control: two or three radio buttons side by side. */
import { h, uniqueId } from './dom.js';

/**
 * @param {object} options
 * @param {string} options.name accessible name
 * @param {{ value: string, label: string }[]} options.choices
 * @param {(value: string) => void} options.change
 */
export function createSegmented({ name, choices, change }) {
  const group = uniqueId('segmented');
  const inputs = choices.map(({ value }) =>
    h('input', {
      type: 'radio',
      name: group,
      value,
      on: { change: () => change(value) },
    }),
  );
  const element = h(
    'div',
    { class: 'segmented', role: 'radiogroup', 'aria-label': name },
    choices.map(({ label }, i) => h('label', { class: 'segment' }, inputs[i], h('span', null, label))),
  );
  return {
    element,
    /** @param {string} value */
    set(value) {
      for (const input of inputs) input.checked = input.value === value;
    },
  };
}
