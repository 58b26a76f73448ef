/** Lists in the picture what stays when the formula changes and affects the surface, with buttons to remove it. */
import { computed } from '@preact/signals-core';
import { button } from '../button.js';
import { h } from '../dom.js';
import { keptOf } from '../kept.js';

/** @import { Engine } from '../../engine/types.js' */

/** @param {Engine} engine @param {() => boolean} [isWanted] */
export function createKept(engine, isWanted = () => true) {
  const kept = computed(() => keptOf(engine));
  const texts = computed(() => JSON.stringify(kept.value.map(({ text }) => text)));
  return h('div', { class: 'kept', role: 'status', hidden: () => kept.value.length === 0 || !isWanted() }, () => {
    // While a slider moves, the buttons stay the same elements.
    void texts.value;
    return kept
      .peek()
      .map(({ text, end, act }) =>
        h('span', null, text, button({ icon: 'close', 'aria-label': end, title: end, press: act })),
      );
  });
}
