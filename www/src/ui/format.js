/** Formats numbers as English text does: with a decimal point, commas between groups, and a true minus sign. */

/** U+2212, which is as wide as a digit. Intl writes a hyphen instead. */
const MINUS = '\u2212';
const THIN_NO_BREAK = '\u202f';
export const MISSING = '\u2013';

/** @type {Map<string, Intl.NumberFormat>} */
const formats = new Map();

/**
 * @param {number} value
 * @param {Intl.NumberFormatOptions} options
 */
function write(value, options) {
  const key = JSON.stringify(options);
  let format = formats.get(key);
  if (!format) {
    format = new Intl.NumberFormat('en', options);
    formats.set(key, format);
  }
  return format.format(value).replace(/-/g, MINUS);
}

/** @param {unknown} value @returns {value is number} */
const isNumber = (value) => typeof value === 'number' && !Number.isNaN(value);

/** Formats an integer with grouped digits. @param {unknown} value */
export function formatCount(value) {
  return isNumber(value) ? write(value, { maximumFractionDigits: 0 }) : MISSING;
}

/** Names the relaxation steps that were timed. @param {number} steps */
export const lastSteps = (steps) => (steps === 1 ? 'the last step' : `the last ${formatCount(steps)} steps`);

/** Groups the digits of integers within a sentence. @param {string} text */
export const withCounts = (text) => text.replace(/(?<![\d.])\d{4,}(?!\.?\d)/g, (digits) => formatCount(Number(digits)));

/**
 * Formats a number with exactly `digits` decimals. A value that would round to zero is written as a power of ten.
 * @param {unknown} value
 * @param {number} [digits]
 */
export function formatFixed(value, digits = 3) {
  if (!isNumber(value)) return MISSING;
  if (!Number.isFinite(value)) return value > 0 ? '∞' : `${MINUS}∞`;
  if (value !== 0 && Math.abs(value) < 0.5 * 10 ** -digits) return formatPower(value);
  const rounded = Number(value.toFixed(digits));
  return write(rounded === 0 ? 0 : value, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

/** Formats a number with as many decimals as `step` has. @param {unknown} value @param {number} step */
export function formatStep(value, step) {
  if (!isNumber(value)) return MISSING;
  return write(value, { maximumFractionDigits: decimalsOf(step) });
}

/** Formats a number with `digits` significant digits. @param {unknown} value @param {number} [digits] */
export function formatSignificant(value, digits = 3) {
  if (!isNumber(value)) return MISSING;
  if (!Number.isFinite(value)) return value > 0 ? '∞' : `${MINUS}∞`;
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e7)) return formatPower(value);
  return write(value, { maximumSignificantDigits: digits });
}

/** @type {Record<string, string>} */
const SUPERSCRIPTS = {
  '-': '⁻',
  0: '⁰',
  1: '¹',
  2: '²',
  3: '³',
  4: '⁴',
  5: '⁵',
  6: '⁶',
  7: '⁷',
  8: '⁸',
  9: '⁹',
};

/** Formats a number as a power of ten, such as 3.1·10⁻⁶. @param {number} value */
function formatPower(value) {
  const [mantissa, exponent] = value.toExponential(1).split('e');
  const power = String(Number(exponent)).replace(/./g, (sign) => SUPERSCRIPTS[sign] ?? sign);
  return `${write(Number(mantissa), { maximumFractionDigits: 1 })}·10${power}`;
}

/** Formats a share as a percentage. @param {unknown} value @param {number} [digits] */
export function formatShare(value, digits = 1) {
  return isNumber(value) ? write(value, { style: 'percent', maximumFractionDigits: digits }) : MISSING;
}

/** Formats a duration: in ms below one second, else in s. @param {unknown} seconds */
export function formatSeconds(seconds) {
  if (!isNumber(seconds)) return MISSING;
  if (seconds < 0.0995) return `${write(seconds * 1000, { maximumFractionDigits: 1 })}${THIN_NO_BREAK}ms`;
  if (seconds < 0.9995) return `${write(seconds * 1000, { maximumFractionDigits: 0 })}${THIN_NO_BREAK}ms`;
  return `${write(seconds, { minimumFractionDigits: 2, maximumFractionDigits: 2 })}${THIN_NO_BREAK}s`;
}

/** Returns the number of decimals of a step such as 0.05 or 1e-4. @param {number} step */
export function decimalsOf(step) {
  if (!(step > 0) || !Number.isFinite(step)) return 6;
  for (let digits = 0; digits < 12; digits += 1) {
    if (Math.abs(step - Number(step.toFixed(digits))) <= step * 1e-9) return digits;
  }
  return 12;
}

/**
 * Returns a count with its noun, such as '12 particles' or '1 particle'.
 * @param {number} count
 * @param {string} one
 * @param {string} [many]
 */
export function plural(count, one, many = `${one}s`) {
  return `${formatCount(count)} ${count === 1 ? one : many}`;
}
