/** The progress bar of a run. */
import { computed } from '@preact/signals-core';
import { h } from './dom.js';

/** @import { Engine } from '../engine/types.js' */

/** Creates the progress bar. @param {Engine} engine */
export function createTrack({ status, reveal, progress, loading }) {
  // The bar follows the reveal of the picture while it lasts, otherwise the run and its report.
  const works = computed(() => status.value !== 'rest');
  const growing = computed(() => works.value || reveal.value !== null || loading.value !== null);
  const fraction = computed(() => {
    if (loading.value) return loading.value.fraction;
    const { particles, fraction: done } = progress.value;
    const share = reveal.value ? reveal.value.particles / Math.max(1, particles) : works.value ? done : 0;
    return Math.round(Math.min(1, share) * 200) / 200;
  });
  return h('div', {
    class: 'progress',
    role: 'progressbar',
    'aria-label': 'Sampling',
    'aria-valuemin': 0,
    'aria-valuemax': 100,
    'aria-valuenow': () => Math.round(fraction.value * 100),
    data: { busy: () => growing.value },
    style: { '--fraction': () => fraction.value },
  });
}
