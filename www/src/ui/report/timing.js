/** Shows the times of the sampling, of each of its phases as figures and bars, and of the measurement. */
import { effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { formatSeconds, formatSignificant, lastSteps } from '../format.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { ReadonlySignal } from '@preact/signals-core'
 */

const PHASES = /** @type {const} */ ([
  ['seeding', 'Seeding'],
  ['generation', 'Generation'],
  ['refinement', 'Refinement'],
  ['relaxation', 'Relaxation'],
]);

/** @param {string} words */
const capital = (words) => words[0].toUpperCase() + words.slice(1);

/**
 * @param {Engine} engine
 * @param {ReadonlySignal<unknown>} report the report, with which the times appear
 */
export function createTiming(engine, report) {
  const section = h('div', { class: 'section timing' });
  effect(() => {
    const timing = engine.timing.value;
    section.hidden = timing === null || timing.particles === 0 || report.value === null;
    if (!timing || section.hidden) return;
    const { steps, sampling, seconds, particles } = timing;
    // Relaxation steps that are made after the sampling have no other phase.
    const phases = PHASES.filter(([key]) =>
      steps > 0 ? key === 'relaxation' : key !== 'refinement' || seconds[key] > 0,
    );
    const longest = Math.max(...phases.map(([key]) => seconds[key]), 1e-9);
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
            h('th', { scope: 'col' }, steps > 0 ? capital(lastSteps(steps)) : 'Sampling'),
            h('th', { scope: 'col' }, h('span', { class: 'visually-hidden' }, 'Share')),
            h('th', { scope: 'col' }, formatSeconds(sampling)),
          ),
        ),
        h(
          'tbody',
          null,
          phases.map(([key, label]) => {
            const bar = h('span', { class: 'bar', 'aria-hidden': 'true' });
            bar.style.width = `${(seconds[key] / longest) * 100}%`;
            return h(
              'tr',
              null,
              h('th', { scope: 'row' }, label),
              h('td', { class: 'bar-cell' }, bar),
              h('td', null, formatSeconds(seconds[key])),
            );
          }),
        ),
      ),
      h(
        'p',
        { class: 'quiet' },
        `${formatSignificant((sampling * 1e6) / particles, 3)}\u202fµs per particle; then ${formatSeconds(seconds.quality)} to measure`,
      ),
    );
  });
  return section;
}
