/**
 * Marks of particles with five and with seven neighbours. One switch shows them in all pictures
 * that are judged.
 */
import { signal } from '@preact/signals-core';
import { h } from '../ui/dom.js';

const isOn = signal(false);

/** Whether the pictures have the marks. An effect that asks runs again once it changes. */
export const isMarked = () => isOn.value;

/** What the marks mean. @param {{ hidden?: () => boolean }} [how] */
export const createMarkKey = ({ hidden = () => false } = {}) =>
  h(
    'ul',
    { class: 'key', hidden },
    h('li', null, h('span', { class: 'dot five' }), 'five neighbours or fewer'),
    h('li', null, h('span', { class: 'dot seven' }), 'seven or more'),
  );

/** The switch, with what the marks mean. */
export function createMarkSwitch() {
  const box = h('input', {
    type: 'checkbox',
    checked: () => isOn.value,
    on: {
      change() {
        isOn.value = box.checked;
      },
    },
  });
  return h(
    'div',
    { class: 'controls mark-switch' },
    h('label', { class: 'check' }, box, h('span', null, 'Mark five and seven neighbours')),
    createMarkKey({ hidden: () => !isOn.value }),
  );
}
