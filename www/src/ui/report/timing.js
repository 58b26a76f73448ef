/** Time per phase, as figures and as one bar. */
import { effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { formatSeconds, formatSignificant } from '../format.js';

const PHASES = /** @type {const} */ ([
  ['seeding', 'Seeding'],
  ['generation', 'Generation'],
  ['relaxation', 'Relaxation'],
  ['quality', 'Quality figures'],
]);

/**
 * @param {import('../../engine/types.js').Engine} engine
 * @param {import('@preact/signals-core').ReadonlySignal<unknown>} report the times appear together with the figures
 */
export function createTiming(engine, report) {
  const section = h('div', { class: 'section timing' });
  effect(() => {
    const timing = engine.timing.value;
    section.hidden = timing === null || timing.particles === 0 || report.value === null;
    if (!timing || section.hidden) return;
    const longest = Math.max(...PHASES.map(([key]) => timing.seconds[key]), 1e-9);
    fill(
      section,
      h(
        'table',
        null,
        h(
          'thead',
          null,
          h(
            'tr',
            null,
            h('th', { scope: 'col' }, 'Time'),
            h('th', { scope: 'col' }, h('span', { class: 'visually-hidden' }, 'Share')),
            h('th', { scope: 'col' }, h('span', { class: 'visually-hidden' }, 'Total '), formatSeconds(timing.total)),
          ),
        ),
        h(
          'tbody',
          null,
          PHASES.map(([key, label]) => {
            const bar = h('span', { class: 'bar', 'aria-hidden': 'true' });
            bar.style.width = `${(timing.seconds[key] / longest) * 100}%`;
            return h(
              'tr',
              null,
              h('th', { scope: 'row' }, label),
              h('td', { class: 'bar-cell' }, bar),
              h('td', null, formatSeconds(timing.seconds[key])),
            );
          }),
        ),
      ),
      h('p', { class: 'quiet' }, `${formatSignificant(timing.us_per_particle, 3)}\u202fµs per particle`),
    );
  });
  return section;
}
