/** The button beside the spacing that takes the brush, and what is painted. */
import { computed } from '@preact/signals-core';
import { canPaint, readDabs } from '../../engine/brush.js';
import { button } from '../button.js';
import { explain } from '../explain.js';
import { plural } from '../format.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Brush } from '../types.js'
 */

/** @param {Engine} engine @param {Brush} brush */
export function createPaint(engine, brush) {
  const count = computed(() => readDabs(engine.state.value.settings.brush)?.length ?? 0);
  const off = () => !canPaint(engine.state.value.settings);
  const paint = button(
    {
      class: 'small',
      'aria-pressed': () => String(brush.on.value),
      off,
      press: () => {
        brush.on.value = !brush.on.peek();
      },
    },
    'Paint',
  );
  const text = () =>
    off()
      ? 'Painting has no effect on adaptive sizes, which follow the curvature. Choose Uniform to paint.'
      : 'Drag over the surface to make its particles finer or coarser there.';
  // While the brush is on, its card has this button, and the panel keeps its height.
  const isSeen = () => !brush.on.value && count.value > 0;
  const clear = button(
    {
      class: 'plain small',
      hidden: () => !isSeen(),
      press: () => engine.resetSetting('brush'),
    },
    () => `Clear ${plural(count.value, 'place')}`,
  );
  return { paint: explain(paint, () => ({ text: text() }), { side: 'above' }), clear, isSeen };
}
