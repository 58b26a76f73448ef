/** The cross in the middle of the picture, at which keys act. */
import { signal } from '@preact/signals-core';

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Pen } from '../types.js'
 */

/** Half the size of the cross. */
const CROSS_PX = 9;

/**
 * Draws the cross while the keyboard is at one of these elements.
 * @param {Engine} engine @param {HTMLElement[]} elements
 */
export function aimOf(engine, elements) {
  const focused = signal(false);
  for (const type of ['focus', 'blur', 'keydown', 'pointerdown'])
    for (const element of elements)
      element.addEventListener(type, () => {
        focused.value = elements.some((one) => one.matches(':focus-visible'));
      });
  return (/** @type {Pen} */ pen) => {
    const at = focused.value ? engine.project(engine.state.value.view.camera.target) : null;
    if (!at) return;
    pen.line({ x: at.x - CROSS_PX, y: at.y }, { x: at.x + CROSS_PX, y: at.y }, 'cross');
    pen.line({ x: at.x, y: at.y - CROSS_PX }, { x: at.x, y: at.y + CROSS_PX }, 'cross');
  };
}
