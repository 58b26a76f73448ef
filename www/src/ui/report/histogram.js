/** How the distances to the nearest particle spread: a plot, and the same as a table. */
import { effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { formatCount, formatFixed } from '../format.js';
import { coarsen, trim } from './bins.js';

/** @typedef {import('../../engine/types.js').Report} Report */

const TABLE_ROWS = 12;
/** Distances are given over the spacing of a perfect hexagonal lattice of as many particles. */
const IDEAL = 1;

/**
 * @param {import('@preact/signals-core').ReadonlySignal<Report | null>} report
 * @param {import('@preact/signals-core').ReadonlySignal<'light' | 'dark'>} theme
 */
export function createHistogram(report, theme) {
  const plot = h('div', { class: 'plot', 'aria-hidden': 'true' });
  const table = h('tbody');
  const section = h(
    'div',
    { class: 'section histogram' },
    h('div', { class: 'section-head' }, h('h3', null, 'Nearest distance'), h('span', { class: 'quiet' }, 'perfect lattice 1')),
    plot,
    h(
      'details',
      null,
      h('summary', { class: 'quiet' }, 'As a table'),
      h('table', null, h('thead', null, h('tr', null, h('th', { scope: 'col' }, 'From'), h('th', { scope: 'col' }, 'To'), h('th', { scope: 'col' }, 'Particles'))), table),
    ),
  );
  effect(() => {
    const current = report.value;
    const bins = current?.nearest_histogram;
    const usable = Boolean(bins && bins.bins.length && bins.max > bins.min);
    section.hidden = !usable;
    if (!bins || !usable) return;
    const shown = trim(bins, IDEAL);
    fill(table, coarsen(shown, TABLE_ROWS).map(({ from, to, count }) => h('tr', null, h('td', null, formatFixed(from, 2)), h('td', null, formatFixed(to, 2)), h('td', null, formatCount(count)))));
    void theme.value;
    void draw(plot, shown);
  });
  return section;
}

/** @type {Promise<typeof import('./histogram-plot.js')> | null} */
let module = null;

/**
 * @param {HTMLElement} plot
 * @param {{ min: number, max: number, bins: number[] }} bins
 */
async function draw(plot, bins) {
  module ??= import('./histogram-plot.js');
  try {
    (await module).drawHistogram(plot, bins);
  } catch {
    module = null;
    plot.hidden = true; // The table says the same.
  }
}
