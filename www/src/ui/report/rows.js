/** Reads the figures of a report by their path and formats them. */
import { formatCount, formatFixed, formatSignificant, MISSING } from '../format.js';

/** @import { Report, ReportRow } from '../../engine/types.js' */

/**
 * Returns the value at a path such as `quality.six_neighbours`. It is null for a non-finite number, which stands for an
 * undefined figure.
 * @param {unknown} root
 * @param {string} key
 * @returns {unknown}
 */
export function valueAt(root, key) {
  /** @type {any} */
  let value = root;
  for (const part of key.split('.')) {
    if (value === null || typeof value !== 'object') return undefined;
    value = value[part];
  }
  return typeof value === 'number' && !Number.isFinite(value) ? null : value;
}

/**
 * Returns whether a relaxation step was made. The energies are those before the first step and after each step.
 * @param {Report} report
 */
const isRelaxed = ({ energy }) => energy !== null && energy.length > 1;

/**
 * Returns a figure and, for a quality figure of a relaxed run, its value before the relaxation.
 * @param {Report} report
 * @param {string} key
 * @returns {{ now: unknown, before: unknown }} undefined for a value that does not exist
 */
export function figuresOf(report, key) {
  const paired = key.startsWith('quality.') && isRelaxed(report);
  const before = paired ? valueAt(report, key.replace(/^quality\./, 'quality_before.')) : undefined;
  return { now: valueAt(report, key), before };
}

/**
 * Returns whether a report has a figure, since not every run has all. Without a report all rows are shown.
 * @param {Report | null} report
 * @param {{key: string, unless?: string | null}} row
 */
export function isTold(report, { key, unless }) {
  const has = (/** @type {string} */ path) => {
    if (!report) return false;
    const { now, before } = figuresOf(report, path);
    return (now ?? before ?? null) !== null;
  };
  return (!report || has(key)) && !(unless && has(unless));
}

/**
 * Returns the headings of the two columns of quality figures: of the particles as placed, and after relaxation. Without
 * a relaxation there is only the second column.
 * @param {Report | null} report
 */
export function headingsOf(report) {
  const placed = report?.refined_levels != null ? 'Refined' : 'Front';
  return report && !isRelaxed(report) ? ['', placed] : [placed, 'Relaxed'];
}

/** Words shown for the core's values. @type {Record<string, string>} */
const WORDS = { proven: 'proven', searched: 'by search' };

/** Largest number of digits of a figure. Decimals of large numbers are not significant. */
const MOST_DIGITS = 5;
/** Number of decimals beyond which a figure is written as a power of ten. */
const TINY_DIGITS = 4;

/** @param {unknown} value */
export const writeWord = (value) => (typeof value === 'string' ? (WORDS[value] ?? value) : MISSING);

/** @param {ReportRow} row @param {unknown} value */
export function writeFigure({ digits, unit }, value) {
  if (typeof value !== 'number') return writeWord(value);
  if (unit === '%') return formatFixed(value * 100, digits);
  // Such figures are usually very small and easier to read as powers of ten.
  if (digits > TINY_DIGITS) return value === 0 ? '0' : formatSignificant(value, 2);
  if (digits === 0) return formatCount(value);
  const whole = Math.max(0, Math.floor(Math.log10(Math.abs(value) || 1)));
  return formatFixed(value, Math.max(0, Math.min(digits, MOST_DIGITS - 1 - whole)));
}

/**
 * Formats a range by its two ends, or as one figure if these are equal.
 * @param {ReportRow} row
 * @param {Report} report
 */
export function writeRange({ key, to }, report) {
  const [low, high] = [key, to ?? key].map((path) => formatSignificant(valueAt(report, path)));
  return low === high ? low : `${low}\u202f–\u202f${high}`;
}

/**
 * Returns whether relaxation has made a figure better, worse, or neither.
 * @param {ReportRow} row
 * @param {unknown} before
 * @param {unknown} now
 */
export function compare({ better, digits, unit }, before, now) {
  if (!better || typeof before !== 'number' || typeof now !== 'number') return 'same';
  const scale = unit === '%' ? 100 : 1;
  const change = (now - before) * scale;
  if (!(Math.abs(change) >= 0.5 * 10 ** -digits)) return 'same';
  return change > 0 === (better === 'higher') ? 'better' : 'worse';
}

/** Groups the rows; groups are in the order of their first rows. @param {ReportRow[]} rows */
export function groupRows(rows) {
  /** @type {Map<string, ReportRow[]>} */
  const groups = new Map();
  for (const row of rows) groups.set(row.group, [...(groups.get(row.group) ?? []), row]);
  return groups;
}
