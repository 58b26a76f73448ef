/** Shows the distribution of the nearest distances, as a plot and as a table. */
import { computed } from '@preact/signals-core';
import { draw, footOf } from '../chart.js';
import { h } from '../dom.js';
import { formatCount, formatFixed } from '../format.js';
import { tableOf } from '../table.js';
import { coarsen, trim } from './bins.js';

/**
 * @import { Engine, ReadonlySignal, Report } from '../../engine/types.js'
 * @import { Drawn } from '../types.js'
 * @import { Bins } from './types.js'
 */

const TABLE_ROWS = 12;
/**
 * Distance of a perfect lattice. Distances are relative to the hexagonal spacing, or in adaptive runs to the particles'
 * diameters.
 */
const IDEAL = 1;

/**
 * @param {ReadonlySignal<Report | null>} report
 * @param {Engine} engine
 */
export function createHistogram(report, { columns }) {
  const bins = computed(() => {
    const bins = report.value?.nearest_histogram;
    return bins?.bins.length && bins.max > bins.min ? trim(bins, IDEAL) : null;
  });
  const chart = computed(() => bins.value && chartOf(bins.value));
  const unit = () => (report.value && columns.adaptive ? 'own diameter 1' : 'perfect lattice 1');
  return h(
    'div',
    { class: 'section histogram', hidden: () => !bins.value },
    h('div', { class: 'section-head' }, h('h3', null, 'Nearest distance'), h('span', { class: 'quiet' }, unit)),
    h('div', { class: 'plot', 'aria-hidden': 'true' }, () => chart.value && draw(chart.value)),
    h('div', { class: 'plot-foot', 'aria-hidden': 'true' }, () => chart.value && footOf(chart.value)),
    h('details', null, h('summary', { class: 'quiet' }, 'As a table'), () => bins.value && tableOfBins(bins.value)),
  );
}

/** @param {Bins} bins @returns {Drawn} */
const chartOf = ({ min, max, bins: counts }) => ({
  kind: 'bars',
  rows: [{ fate: 'new', name: 'particles', counts }],
  first: 0,
  at: null,
  format: formatCount,
  ends: [formatFixed(min, 2), formatFixed(max, 2)],
  ideal: (IDEAL - min) / (max - min),
});

/** @param {Bins} bins */
const tableOfBins = (bins) =>
  tableOf({
    head: ['From', 'To', 'Particles'],
    rows: coarsen(bins, TABLE_ROWS).map(({ from, to, count }) => [
      formatFixed(from, 2),
      formatFixed(to, 2),
      formatCount(count),
    ]),
  });
