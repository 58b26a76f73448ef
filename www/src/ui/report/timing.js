/** Shows the time of sampling, of each of its phases as figures and bars, and of the measurement. */
import { computed } from '@preact/signals-core';
import { h } from '../dom.js';
import { formatSeconds, formatSignificant, lastSteps } from '../format.js';
import { tableOf } from '../table.js';

/** @import { Engine, ReadonlySignal, Timing } from '../../engine/types.js' */

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
export function createTiming({ timing }, report) {
  const shown = computed(() => (report.value !== null && timing.value?.particles ? timing.value : null));
  return h(
    'div',
    { class: 'section timing', hidden: () => !shown.value },
    () => shown.value && [tableOfTimes(shown.value), perParticle(shown.value)],
  );
}

/** @param {Timing} timing */
function tableOfTimes({ steps, sampling, seconds }) {
  // Steps made after the sampling have only the relaxation phase.
  const phases = PHASES.filter(([key]) =>
    steps > 0 ? key === 'relaxation' : key !== 'refinement' || seconds[key] > 0,
  );
  const longest = Math.max(...phases.map(([key]) => seconds[key]), 1e-9);
  return tableOf({
    head: [
      steps > 0 ? capital(lastSteps(steps)) : 'Sampling',
      h('span', { class: 'visually-hidden' }, 'Share'),
      formatSeconds(sampling),
    ],
    rows: phases.map(([key, label]) => {
      const width = `${(seconds[key] / longest) * 100}%`;
      return [label, h('span', { class: 'bar', 'aria-hidden': 'true', style: { width } }), formatSeconds(seconds[key])];
    }),
  });
}

/** @param {Timing} timing */
function perParticle({ sampling, seconds, particles }) {
  const each = formatSignificant((sampling * 1e6) / particles, 3);
  return h('p', { class: 'quiet' }, `${each}\u202fµs per particle; then ${formatSeconds(seconds.quality)} to measure`);
}
