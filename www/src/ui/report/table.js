/** Shows the report's rows as a table. Every label has an explanation of its figure. */
import { effect } from '@preact/signals-core';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { listOf } from './places.js';
import { compare, figuresOf, groupRows, headingsOf, isTold, writeFigure, writeRange } from './rows.js';

/**
 * @import { Report, ReportRow } from '../../engine/types.js'
 * @import { ReadonlySignal } from '@preact/signals-core'
 */

/**
 * Creates one table for all groups, so that the figures are aligned. Units are part of the labels.
 * @param {ReadonlySignal<Report | null>} report
 * @param {ReportRow[]} rows
 * @param {object} parts
 * @param {ReadonlySignal<number>} parts.counted  particles of a run without a report yet, or 0
 * @param {(row: ReportRow) => void} parts.show  shows the next place that a figure is about
 */
export function createTable(report, rows, parts) {
  const groups = [...groupRows(rows)];
  const headed = groups.findIndex(([, members]) => members.some(isPaired));
  const table = h(
    'table',
    { class: 'figures', 'aria-label': 'Figures of the run' },
    groups.map(([group, members], i) =>
      h(
        'tbody',
        { hidden: () => !members.some((row) => isTold(report.value, row)) },
        h(
          'tr',
          { class: 'group' },
          h('th', { scope: 'rowgroup' }, group),
          [0, 1].map((column) => h('td', null, i === headed && (() => headingsOf(report.value)[column]))),
        ),
        members.map((row) => createRow(report, row, parts)),
      ),
    ),
  );
  return h('div', { class: 'section', hidden: () => report.value === null }, table);
}

/** @param {ReportRow} row */
const isPaired = ({ key }) => key.startsWith('quality.');

/**
 * @param {ReadonlySignal<Report | null>} report
 * @param {ReportRow} row
 * @param {Parameters<typeof createTable>[2]} parts
 */
function createRow(report, row, { counted, show }) {
  const term = h(
    'button',
    { type: 'button', class: 'term' },
    row.label,
    row.unit ? h('span', { class: 'unit' }, `\u00a0${row.unit}`) : null,
  );
  explain(term, () => ({ title: row.label, text: row.help, ideal: idealOf(row, report.peek()) }), {
    tap: true,
    side: 'left',
  });
  const before = h('td');
  const now = h('td', { class: 'now' });
  const write = createFigure(row, show);
  effect(() => {
    const current = report.value;
    let figures = current ? figuresOf(current, row.key) : null;
    if (figures && row.key === 'count') figures = { ...figures, now: counted.value || figures.now };
    // The places are those of the present particles.
    const has = listOf(current, row.places).length > 0;
    const is = figures?.now === undefined ? 'before' : 'now';
    write(before, writeFigure(row, figures?.before), has && is === 'before');
    write(now, current && row.to ? writeRange(row, current) : writeFigure(row, figures?.now), has && is === 'now');
    now.dataset.change = figures ? compare(row, figures.before, figures.now) : 'same';
  });
  const paired = isPaired(row);
  const head = h('th', { scope: 'row' }, term);
  const line = h('tr', null, head, paired ? before : null, now);
  effect(() => {
    const current = report.value;
    line.hidden = !isTold(current, row);
    if (paired) return;
    // A range or a word spans both columns.
    const wide = row.to || (current && typeof figuresOf(current, row.key).now === 'string');
    head.colSpan = wide ? 1 : 2;
    now.colSpan = wide ? 2 : 1;
  });
  return line;
}

/**
 * Returns a function that writes a figure into a cell, as a button if it has places in the picture.
 * @param {ReportRow} row
 * @param {(row: ReportRow) => void} show
 */
function createFigure(row, show) {
  const button = h('button', { type: 'button', class: 'shows', on: { click: () => show(row) } });
  explain(
    button,
    () => ({ title: 'Show it in the picture', text: 'The worst place comes first; press again for the next one.' }),
    { side: 'left' },
  );
  return (/** @type {HTMLElement} */ cell, /** @type {string} */ text, /** @type {boolean} */ pressable) => {
    if (!pressable) {
      cell.textContent = text;
      return;
    }
    button.textContent = text;
    button.setAttribute('aria-label', `${row.label} ${text}, show it in the picture`);
    if (button.parentElement !== cell) cell.replaceChildren(button);
  };
}

const CHANGES = { better: 'Relaxation made it better.', worse: 'Relaxation made it worse.', same: '' };

/** @param {ReportRow} row @param {Report | null} report */
function idealOf(row, report) {
  const { ideal, better } = row;
  const direction = better === 'higher' ? 'Higher is better.' : better === 'lower' ? 'Lower is better.' : '';
  const figures = report && figuresOf(report, row.key);
  const change = figures ? CHANGES[compare(row, figures.before, figures.now)] : '';
  return (
    [ideal ? `Ideal: ${ideal}${/[.!]$/.test(ideal) ? '' : '.'}` : '', direction, change].filter(Boolean).join(' ') ||
    undefined
  );
}
