/** Says in the picture what stays when the formula changes and hides or changes the surface, and ends it. */
import { computed } from '@preact/signals-core';
import { dot, triple } from '../../engine/vector.js';
import { button } from '../button.js';
import { h } from '../dom.js';
import { formatSignificant } from '../format.js';
import { equationOf } from '../space.js';

/** @import { Columns, CuttingPlane, Engine } from '../../engine/types.js' */

/** @typedef {{ text: string, end: string, act: () => void }} Kept */

/**
 * Returns whether a plane hides every particle.
 * @param {Pick<Columns, 'count' | 'positions'>} columns @param {CuttingPlane} plane
 */
export function hidesAll({ count, positions }, { normal, offset }) {
  for (let i = 0; i < count; i += 1) if (dot(normal, triple(positions, i)) <= offset) return false;
  return count > 0;
}

/** @param {Engine} engine @returns {Kept[]} */
function keptOf(engine) {
  const { plane, settings } = engine.state.value;
  void engine.revision.value;
  /** @type {Kept[]} */
  const kept = [];
  if (plane) {
    const equation = equationOf(plane);
    kept.push({
      text: `${equation ? `Cut at ${equation}` : 'Cut by a plane'}${hidesAll(engine.columns, plane) ? ', which hides everything' : ''}`,
      end: 'End the cut',
      act: () => engine.setPlane(null),
    });
  }
  if (settings.thickness !== undefined)
    kept.push({
      text: `Thickness ${formatSignificant(Number(settings.thickness), 3)}`,
      end: 'End the thickness',
      act: () => engine.resetSetting('thickness'),
    });
  if (settings.box_faces !== undefined)
    kept.push({
      text: 'Closed by the box',
      end: 'Open it again',
      act: () => engine.resetSetting('box_faces'),
    });
  return kept;
}

/** @param {Engine} engine */
export function createKept(engine) {
  const kept = computed(() => keptOf(engine));
  const texts = computed(() => JSON.stringify(kept.value.map(({ text }) => text)));
  return h('div', { class: 'kept', role: 'status', hidden: () => kept.value.length === 0 }, () => {
    // While a slider moves the buttons stay the same elements.
    void texts.value;
    return kept
      .peek()
      .map(({ text, end, act }) =>
        h('span', null, text, button({ icon: 'close', 'aria-label': end, title: end, press: act })),
      );
  });
}
