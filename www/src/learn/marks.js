/**
 * Marks of particles with five and seven neighbours. One switch controls them in all pictures to be judged.
 */
import { signal } from '@preact/signals-core';
import { h } from '../ui/dom.js';

const isOn = signal(false);

/** Whether the pictures have marks. An effect that calls this runs again when it changes. */
export const isMarked = () => isOn.value;

/** The key of the marks. @param {{ hidden?: () => boolean }} [how] */
export const createMarkKey = ({ hidden = () => false } = {}) =>
  h(
    'ul',
    { class: 'key', hidden },
    h('li', null, h('span', { class: 'dot five' }), 'five neighbours or fewer'),
    h('li', null, h('span', { class: 'dot seven' }), 'seven or more'),
  );

/** The switch, with the key of the marks. */
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
