/** Shows the report's rows as a table. Every label has an explanation of its figure. */
import { computed } from '@preact/signals-core';
import { term } from '../button.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { listOf } from './places.js';
import { compare, figuresOf, groupRows, headingsOf, isTold, writeFigure, writeRange } from './rows.js';

/**
 * @import { ReadonlySignal, Report, ReportRow } from '../../engine/types.js'
 * @import { TableOptions } from './types.js'
 */

/**
 * Creates one table for all groups, so that the figures are aligned. Units are part of the labels.
 * @param {ReadonlySignal<Report | null>} report
 * @param {ReportRow[]} rows
 * @param {TableOptions} parts
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
function createRow(report, row, { counted, show, stale }) {
  const help = () => ({ title: row.label, text: row.help, ideal: idealOf(row, report.peek()) });
  const figures = computed(() => {
    const found = report.value && figuresOf(report.value, row.key);
    return found && row.key === 'count' ? { ...found, now: counted.value || found.now } : found;
  });
  const change = () => (figures.value ? compare(row, figures.value.before, figures.value.now) : 'same');
  const paired = isPaired(row);
  const before = () => (figures.value?.before === undefined ? '' : writeFigure(row, figures.value.before));
  const now = () => (report.value && row.to ? writeRange(row, report.value) : writeFigure(row, figures.value?.now));
  // A range or a word spans both columns.
  const wide = () => Boolean(row.to || typeof figures.value?.now === 'string');
  return h(
    'tr',
    { hidden: () => !isTold(report.value, row) },
    h(
      'th',
      { scope: 'row', colspan: () => (paired || wide() ? 1 : 2) },
      term(help, { side: 'left' }, row.label, row.unit && unitOf(row.unit)),
    ),
    paired && h('td', null, before),
    h(
      'td',
      { class: 'now', data: { change }, colspan: () => (!paired && wide() ? 2 : 1) },
      figureOf(now, () => listOf(report.value, row.places).length > 0, { row, show, stale }),
    ),
  );
}

/** @param {string} unit */
const unitOf = (unit) => h('span', { class: 'unit' }, `\u00a0${unit}`);

/**
 * A figure, as a button if it has places in the picture. The button keeps the focus when a new report changes its text.
 * @param {() => string} text @param {() => boolean} isPlaced
 * @param {{ row: ReportRow } & Pick<TableOptions, 'show' | 'stale'>} parts
 */
function figureOf(text, isPlaced, { row, show, stale }) {
  const hasPlaces = computed(isPlaced);
  const label = () => `${row.label} ${text()}, show it in the picture`;
  const press = () => show(row);
  return () => {
    if (!hasPlaces.value) return text();
    return explain(
      h(
        'button',
        // During a run the figure belongs to earlier particles, whose places no longer exist.
        {
          type: 'button',
          class: 'shows',
          'aria-label': label,
          'aria-disabled': () => String(stale.value),
          on: { click: press },
        },
        text,
      ),
      () => ({ title: 'Show it in the picture', text: 'The worst place comes first; press again for the next one.' }),
      { side: 'left' },
    );
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
