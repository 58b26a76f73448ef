/** The cost of placing, of relaxing and of the other method, in evaluations, pushes and rounds. */
import { h } from '../../ui/dom.js';
import { formatCount, formatSignificant } from '../../ui/format.js';
import { tableOf } from '../../ui/table.js';
import { costOf } from '../measure.js';

/** @import { Context } from '../types.js' */

/** A table with bars in its cells. @param {Context} context */
export async function cost({ lab, stops }) {
  const { particles, others, rows } = await costOf(await lab);
  const kinds = /** @type {const} */ ([
    ['evaluations', 'Evaluations of f for each particle'],
    ['pushes', 'Pushes summed for each particle'],
    ['rounds', 'Rounds'],
  ]);
  const most = kinds.map(([kind]) => Math.max(1e-9, ...rows.map((row) => row[kind])));
  const isOpen = () => stops.isOpen('predict-pushes');
  const cell = (/** @type {number} */ value, /** @type {number} */ of) => [
    h('span', { class: 'cost-number' }, () => (isOpen() ? formatSignificant(value, 3) : '?')),
    h('span', { class: 'cost-bar', style: { width: () => `${isOpen() ? (100 * value) / of : 0}%` } }),
  ];
  return [
    tableOf({
      class: 'cost',
      caption: `Here: ${formatCount(particles)} particles of the front, ${formatCount(others)} of the system`,
      head: ['', ...kinds.map(([, name]) => name)],
      rows: rows.map((row) => [row.name, ...kinds.map(([kind], k) => cell(row[kind], most[k]))]),
    }),
  ];
}
