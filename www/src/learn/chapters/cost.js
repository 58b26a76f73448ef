/** The chapter on the cost of placing and of relaxing, in evaluations of f. */
import { h } from '../../ui/dom.js';
import { formatCount, formatSignificant } from '../../ui/format.js';

/** @import { Context, Lab } from '../types.js' */

/** Steps of Witkin and Heckbert's system for 10,633 particles on an ellipsoid, as Table 1 of the paper has it. */
const STEPS_OF_TABLE_1 = 373;

/** @param {Lab} lab */
export async function costOf(lab) {
  const { progress, placing } = await lab.run({}, { keep: true });
  const { particles, evaluations } = progress;
  return { particles, placing, resting: evaluations - placing };
}

/** A table with bars in its cells. @param {Context} context */
export async function cost({ lab, stops }) {
  const { particles, placing, resting } = await costOf(await lab);
  const rows = [
    { name: 'Placing, once', value: placing, kind: 'own' },
    { name: 'Ten steps of relaxation', value: resting, kind: 'own' },
    {
      name: `${formatCount(STEPS_OF_TABLE_1)} steps, as the paper counts for Witkin and Heckbert’s system`,
      value: (resting / 10) * STEPS_OF_TABLE_1,
      kind: 'other',
    },
  ];
  const most = Math.max(...rows.map(({ value }) => value));
  const table = h(
    'table',
    { class: 'cost', hidden: () => !stops.isOpen('predict-cost') },
    h('caption', null, `Evaluations of f for each of ${formatCount(particles)} particles`),
    h(
      'tbody',
      null,
      rows.map(({ name, value, kind }) =>
        h(
          'tr',
          null,
          h('th', { scope: 'row' }, name),
          h(
            'td',
            { class: 'cost-cell' },
            h('span', { class: 'cost-bar', data: { kind }, style: { width: `${(100 * value) / most}%` } }),
          ),
          h('td', null, formatSignificant(value / particles, 3)),
        ),
      ),
    ),
  );
  const waiting = h(
    'p',
    { class: 'figure-count', hidden: () => stops.isOpen('predict-cost') },
    'The bars come with the answer.',
  );
  return [table, waiting];
}
