/** Shows the distribution of the nearest distances, as a plot and as a table. */
import { effect } from '@preact/signals-core';
import { draw, footOf } from '../chart.js';
import { fill, h } from '../dom.js';
import { formatCount, formatFixed } from '../format.js';
import { coarsen, overDiameters, trim } from './bins.js';

/**
 * @import { Engine, Report } from '../../engine/types.js'
 * @import { Drawn } from '../chart.js'
 * @import { ReadonlySignal } from '@preact/signals-core'
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
  const plot = h('div', { class: 'plot', 'aria-hidden': 'true' });
  const foot = h('div', { class: 'plot-foot', 'aria-hidden': 'true' });
  const table = h('tbody');
  const unit = h('span', { class: 'quiet' });
  const section = h(
    'div',
    { class: 'section histogram' },
    h('div', { class: 'section-head' }, h('h3', null, 'Nearest distance'), unit),
    plot,
    foot,
    h(
      'details',
      null,
      h('summary', { class: 'quiet' }, 'As a table'),
      h(
        'table',
        null,
        h(
          'thead',
          null,
          h(
            'tr',
            null,
            h('th', { scope: 'col' }, 'From'),
            h('th', { scope: 'col' }, 'To'),
            h('th', { scope: 'col' }, 'Particles'),
          ),
        ),
        table,
      ),
    ),
  );
  effect(() => {
    const current = report.value;
    // In an adaptive run each distance is relative to the diameter of its particle.
    const bins =
      columns.adaptive && columns.nearest ? overDiameters(columns.nearest, columns.radii) : current?.nearest_histogram;
    unit.textContent = columns.adaptive ? 'own diameter 1' : 'perfect lattice 1';
    const usable = Boolean(bins?.bins.length && bins.max > bins.min);
    section.hidden = !usable;
    if (!bins || !usable) return;
    const shown = trim(bins, IDEAL);
    fill(
      table,
      coarsen(shown, TABLE_ROWS).map(({ from, to, count }) =>
        h(
          'tr',
          null,
          h('td', null, formatFixed(from, 2)),
          h('td', null, formatFixed(to, 2)),
          h('td', null, formatCount(count)),
        ),
      ),
    );
    const { min, max, bins: counts } = shown;
    const ends = [formatFixed(min, 2), formatFixed(max, 2)];
    const ideal = (IDEAL - min) / (max - min);
    const rows = [{ fate: 'new', name: 'particles', counts }];
    /** @type {Drawn} */
    const chart = { kind: 'bars', rows, first: 0, at: null, format: formatCount, ends, ideal };
    fill(plot, draw(chart));
    fill(foot, footOf(chart));
  });
  return section;
}
