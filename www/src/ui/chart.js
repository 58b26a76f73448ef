/**
 * Draws charts: stacked bars from 0 up, or lines. The drawing is stretched to the width of the chart, so it contains no
 * text.
 */
import { h, s } from './dom.js';
import { formatCount } from './format.js';

/** @import { Drawn } from './types.js' */

/** Height of the stack at each place. @param {Drawn['rows']} rows */
const sums = (rows) => rows[0].counts.map((_, k) => rows.reduce((sum, { counts }) => sum + counts[k], 0));

/**
 * The upper end of the scale, which begins at 0 unless the chart gives a `floor`.
 * @param {Drawn} chart
 */
const mostOf = ({ kind, rows, guide = [] }) =>
  Math.max(...(kind === 'line' ? rows.flatMap(({ counts }) => counts) : sums(rows)), ...guide, 1e-12);

/** The lower end of the scale as text. @param {Drawn} chart */
export const floorOf = ({ floor, format }) => (floor === undefined ? '0' : format(floor));

/** The largest value as text. @param {Drawn} chart */
export const scaleOf = (chart) => chart.format(mostOf(chart));

/** Returns the line below a chart: its first and last place, and a legend of several fates. @param {Drawn} chart */
export function footOf({ rows, first, ends: named }) {
  const words = named ?? [formatCount(first), formatCount(first + rows[0].counts.length - 1)];
  const ends = words.map((text) => h('span', null, text));
  if (rows.length < 2) return ends;
  const key = rows.map(({ fate, name }) => h('span', null, h('i', { class: `swatch fate-${fate}` }), name));
  return [ends[0], h('span', { class: 'chart-key' }, key), ends[ends.length - 1]];
}

/** Height of the largest value, as a share of the drawing. */
const RISE = 0.94;

/** @param {Drawn} chart */
export function draw(chart) {
  const { kind, rows, first, at, ideal, guide = [], floor = 0 } = chart;
  const places = rows[0].counts.length;
  const high = mostOf(chart) - floor;
  const y = (/** @type {number} */ value) => +(1 - RISE * ((value - floor) / high)).toFixed(4);
  const svg = s('svg', { viewBox: `0 0 ${places} 1`, preserveAspectRatio: 'none', 'aria-hidden': 'true' });
  if (at !== null && at >= first && at < first + places)
    svg.append(s('rect', { class: 'chart-at', x: at - first, y: 0, width: 1, height: 1 }));
  if (kind === 'line') {
    for (const { fate, counts } of rows) {
      const points = counts.map((value, k) => `${k + 0.5} ${y(value)}`);
      svg.append(s('path', { class: `chart-line fate-${fate}`, d: `M${points.join('L')}` }));
      svg.append(s('path', { class: `chart-dots fate-${fate}`, d: points.map((point) => `M${point}h0`).join('') }));
    }
    return svg;
  }
  const below = new Array(places).fill(0);
  for (const { fate, counts } of rows) {
    const d = counts.map((count, k) => {
      const from = below[k];
      below[k] += count;
      return count > 0 ? `M${k + 0.1} ${y(from)}V${y(below[k])}h.8V${y(from)}z` : '';
    });
    svg.append(s('path', { class: `fate-${fate}`, d: d.join('') }));
  }
  if (guide.length > 0)
    svg.append(
      s('path', { class: 'chart-ideal', d: `M${guide.map((value, k) => `${k + 0.5} ${y(value)}`).join('L')}` }),
    );
  if (ideal !== undefined) svg.append(s('path', { class: 'chart-ideal', d: `M${ideal * places} 0V1` }));
  return svg;
}
