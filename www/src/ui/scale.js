/** Converts between the position of a slider (0 to 1) and its value, on linear and logarithmic scales. */

import { clamp } from '../engine/vector.js';
import { decimalsOf } from './format.js';

/** @import { Scale } from './types.js' */

/** Returns whether a scale is logarithmic and its logarithm is defined on the whole range. @param {Scale} scale */
const isLog = (scale) => scale.scale === 'log' && scale.min > 0 && scale.max > scale.min;

/** Returns the position of `value`, 0 to 1. @param {Scale} scale @param {number} value */
export function toPlace(scale, value) {
  const { min, max } = scale;
  if (!(max > min) || Number.isNaN(value)) return 0;
  const held = clamp(value, min, max);
  return isLog(scale) ? Math.log(held / min) / Math.log(max / min) : (held - min) / (max - min);
}

/**
 * Returns the grid value at a position. `fineness` divides the grid (10 with Shift).
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

/** Significant digits of values on a logarithmic scale. */
const LOG_DIGITS = 3;

/**
 * Returns the nearest grid value within the range: a multiple of the step, or three significant digits on a logarithmic
 * scale. `fineness` divides the grid; integers stay integers.
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
  // The grid starts at 0, not at `min`: 0.05 to 3 in steps of 0.1 gives 0.1, 0.2 …
  return clamp(Number((Math.round(value / step) * step).toFixed(decimalsOf(step))), min, max);
}

/**
 * Returns the value after a number of key presses.
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
    // If the grid is coarser than the factor, the value moves by one grid unit.
    return snap(
      scale,
      value + Math.sign(presses) * (scale.integer ? 1 : 10 ** (Math.floor(Math.log10(value)) - LOG_DIGITS)),
      10,
    );
  }
  const step = (scale.step > 0 ? scale.step : (scale.max - scale.min) / 100) / (scale.integer ? 1 : fineness);
  return snap(scale, value + presses * step, fineness);
}

/** Presses for each key of a slider. @type {Record<string, number>} */
export const KEYS = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
};

/**
 * Returns the value after a key of a slider was pressed, with Shift ten times finer; null for any other key.
 * @param {Scale} scale @param {number} value
 * @param {Pick<KeyboardEvent, 'key' | 'shiftKey' | 'altKey' | 'ctrlKey' | 'metaKey'>} event
 */
export function afterKey(scale, value, { key, shiftKey, altKey, ctrlKey, metaKey }) {
  const presses = KEYS[key];
  if (presses === undefined || altKey || ctrlKey || metaKey) return null;
  return Number.isFinite(presses)
    ? nudge(scale, value, presses, shiftKey)
    : snap(scale, presses > 0 ? scale.max : scale.min);
}

/** Largest number of values that a slider can select. Random seeds have more and get only a number box. */
const SLIDER_PLACES = 20000;

/**
 * Returns whether a slider is useful for a setting.
 * @param {{ kind: string, scale: string, min: number, max: number, step: number }} info
 */
export function wantsSlider(info) {
  if (info.kind === 'choice') return false;
  return (
    info.scale === 'log' || info.kind === 'number' || (info.max - info.min) / Math.max(info.step, 1) <= SLIDER_PLACES
  );
}
