/**
 * The layer of marks on the picture: lines and figures at places of the surface, and handles to drag. They are redrawn
 * after every picture, in which places may have moved.
 */
import { computed } from '@preact/signals-core';
import { h, live } from '../../dom.js';
import { drawn } from './draw.js';

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Mark } from '../types.js'
 */

/**
 * @param {HTMLElement} stage
 * @param {Engine} engine
 * @param {Mark[]} marks
 */
export function mountMarks(stage, engine, marks) {
  const layer = h('div', { class: 'marks' });
  stage.append(layer);
  for (const mark of marks) {
    const pen = drawn(layer, engine);
    const handles = mark.handles ?? [];
    layer.append(...handles);
    const shown = computed(() => engine.backend.value !== 'starting' && mark.shown());
    live(layer, () => {
      for (const handle of handles) handle.hidden = !shown.value;
      pen.begin();
      if (shown.value) {
        void engine.frame.value;
        mark.draw(pen);
      }
      pen.end();
    });
  }
  return layer;
}
