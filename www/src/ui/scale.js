/** Between a slider's place (0 to 1) and its value, on linear and logarithmic scales. */
import { decimalsOf } from './format.js';

/**
 * @typedef {object} Scale
 * @property {number} min
 * @property {number} max
 * @property {number} step the grid of values, 0 for none; on a logarithmic scale the factor of one key press, minus one
 * @property {'linear' | 'log'} [scale]
 * @property {boolean} [integer]
 */

/** @param {number} value @param {number} lo @param {number} hi */
export const clamp = (value, lo, hi) => Math.min(Math.max(value, lo), hi);

/** Whether the logarithm is defined on the whole range. @param {Scale} scale */
const isLog = (scale) => scale.scale === 'log' && scale.min > 0 && scale.max > scale.min;

/** Place of `value`, 0 to 1. @param {Scale} scale @param {number} value */
export function toPlace(scale, value) {
  const { min, max } = scale;
  if (!(max > min) || Number.isNaN(value)) return 0;
  const held = clamp(value, min, max);
  return isLog(scale) ? Math.log(held / min) / Math.log(max / min) : (held - min) / (max - min);
}

/**
 * Value at a place, on the grid. `fineness` divides the grid (10 under shift).
 * @param {Scale} scale
 * @param {number} place
 * @param {number} [fineness]
 */
export function toValue(scale, place, fineness = 1) {
  const { min, max } = scale;
  const held = clamp(place, 0, 1);
  const value = isLog(scale) ? min * (max / min) ** held : min + held * (max - min);
  return snap(scale, value, fineness);
}

/** Significant digits that a logarithmic scale keeps. */
const LOG_DIGITS = 3;

/**
 * The nearest grid value within the range: multiples of the step, or on a logarithmic scale three significant digits.
 * `fineness` divides the grid; whole numbers stay whole.
 * @param {Scale} scale
 * @param {number} value
 * @param {number} [fineness]
 */
export function snap(scale, value, fineness = 1) {
  const { min, max, integer } = scale;
  let step = scale.step / fineness;
  if (isLog(scale)) step = value > 0 ? 10 ** (Math.floor(Math.log10(value)) - LOG_DIGITS + 1) / fineness : 0;
  if (integer) step = Math.max(1, Math.round(step));
  if (!(step > 0)) return clamp(value, min, max);
  // The grid does not start at `min`: 0.05 to 3 by 0.1 should still give 0.1, 0.2 …
  return clamp(Number((Math.round(value / step) * step).toFixed(decimalsOf(step))), min, max);
}

/**
 * The value a number of key presses away.
 * @param {Scale} scale
 * @param {number} value
 * @param {number} presses signed; 10 for a page
 * @param {boolean} fine
 */
export function nudge(scale, value, presses, fine) {
  const fineness = fine ? 10 : 1;
  if (isLog(scale)) {
    const moved = snap(scale, value * (1 + scale.step / fineness) ** presses, 10);
    if (moved !== value) return moved;
    // Too coarse a grid for so small a factor: one unit of the grid instead.
    return snap(
      scale,
      value + Math.sign(presses) * (scale.integer ? 1 : 10 ** (Math.floor(Math.log10(value)) - LOG_DIGITS)),
      10,
    );
  }
  const step = (scale.step > 0 ? scale.step : (scale.max - scale.min) / 100) / (scale.integer ? 1 : fineness);
  return snap(scale, value + presses * step, fineness);
}

/** Beyond so many places a slider cannot be aimed: seeds get a number box alone. */
const SLIDER_PLACES = 20000;

/**
 * Whether a slider helps to choose this number.
 * @param {{ kind: string, scale: string, min: number, max: number, step: number }} info
 */
export function wantsSlider(info) {
  if (info.kind === 'choice') return false;
  return (
    info.scale === 'log' || info.kind === 'number' || (info.max - info.min) / Math.max(info.step, 1) <= SLIDER_PLACES
  );
}
