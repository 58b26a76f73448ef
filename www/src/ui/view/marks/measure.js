/** Measures the distance of two particles: rings on them, a line between them, and a card with the figures. */

import { computed } from '@preact/signals-core';
import { button } from '../../button.js';
import { h } from '../../dom.js';
import { formatCount, formatSignificant } from '../../format.js';
import { separation } from '../../space.js';
import { aimOf } from './aim.js';

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Mark } from '../types.js'
 */

/** Smallest radius of a ring around a particle. */
const RING_PX = 6;

/** @param {Engine} engine */
const present = (engine) => {
  // The particles change with the revision.
  void engine.revision.value;
  const { count, stale } = engine.columns;
  return (engine.state.value.view.measured ?? []).filter((index) => !stale && index < count);
};

/** @param {Engine} engine @param {HTMLElement} host  of the picture @returns {Mark} */
export function measureMark(engine, host) {
  const chosen = computed(() => present(engine));
  const aim = aimOf(engine, [host]);
  return {
    shown: () => engine.state.value.view.measured !== null,
    draw(pen) {
      const { positions, radii } = engine.columns;
      const spots = chosen.value.flatMap((index) => {
        const spot = engine.project(positions.subarray(3 * index, 3 * index + 3));
        if (!spot) return [];
        pen.ring(spot, Math.max(RING_PX, radii[index] / spot.perPx), 'marked');
        return [spot];
      });
      if (spots.length === 2) {
        const [a, b] = spots;
        pen.line(a, b, 'marked');
        const { units } = separation(engine.columns, chosen.value);
        pen.text({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 - 10 }, formatSignificant(units, 4), 'figure strong');
      }
      aim(pen);
    },
  };
}

/** Creates the card that says what to do and what was measured. @param {Engine} engine */
export function createMeasureCard(engine) {
  const chosen = computed(() => present(engine));
  const text = h('span', { role: 'status' }, () => {
    if (engine.state.value.view.measured === null) return '';
    const pair = chosen.value;
    if (pair.length === 0) return 'Press a particle, or turn it under the cross and press Enter';
    if (pair.length === 1) return `Particle ${formatCount(pair[0])}: now another one`;
    const { units, diameters, unit } = separation(engine.columns, pair);
    const [i, j] = pair.map(formatCount);
    return `${formatSignificant(units, 4)} apart, ${formatSignificant(diameters, 3)} × ${unit} · particles ${i} and ${j}`;
  });
  const done = button({ class: 'small', press: () => engine.setView({ measured: null }) }, 'Done');
  return h(
    'div',
    { class: 'tool-card measure-card', hidden: () => engine.state.value.view.measured === null },
    text,
    done,
  );
}
