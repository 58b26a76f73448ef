/** The clip box: the message and remedy when it cuts the surface, and the operations on it. */
import { clamp, vec } from '../engine/vector.js';

/** @import { Bounds, Engine, Report } from '../engine/types.js' */

/** Returns a box of twice the size around the same middle. @param {Bounds} bounds @returns {Bounds} */
export function doubled({ min, max }) {
  const end = (/** @type {1 | -1} */ side) => vec((k) => (min[k] + max[k]) / 2 + side * (max[k] - min[k]));
  return { min: end(-1), max: end(1) };
}

/**
 * Returns the box with the same centre that holds a number of whole periods along every periodic axis.
 * @param {Bounds} bounds @param {readonly (number | null)[]} periods  0 or null for axes without a period
 * @param {number} times
 */
export function wholePeriods({ min, max }, periods, times) {
  /** @type {Bounds} */
  const next = { min: [...min], max: [...max] };
  for (const [k, period] of periods.entries()) {
    if (!period) continue;
    const middle = (min[k] + max[k]) / 2;
    [next.min[k], next.max[k]] = [middle - (times * period) / 2, middle + (times * period) / 2];
  }
  return next;
}

/** Least extent of the box after a drag, as a share of the extent before. */
const LEAST_SHARE = 0.02;
/** Significant digits of a side that a drag sets. */
const SIDE_DIGITS = 3;

/**
 * Returns a box with one face moved, at most to the opposite face.
 * @param {Bounds} bounds
 * @param {number} axis
 * @param {'min' | 'max'} end
 * @param {number} value
 */
export function withFace(bounds, axis, end, value) {
  const side = bounds.max[axis] - bounds.min[axis];
  const [low, high] =
    end === 'max'
      ? [bounds.min[axis] + LEAST_SHARE * side, Infinity]
      : [-Infinity, bounds.max[axis] - LEAST_SHARE * side];
  const grid = 10 ** (Math.floor(Math.log10(side)) - SIDE_DIGITS + 1);
  const rounded = Number((Math.round(value / grid) * grid).toPrecision(12));
  /** @type {Bounds} */
  const next = { min: [...bounds.min], max: [...bounds.max] };
  next[end][axis] = clamp(rounded, low, high);
  return next;
}

/**
 * Returns the message for a surface that the box cuts, and the remedy: a larger or a newly fitted box.
 * @param {Pick<Report, 'cut' | 'border'> | null} report
 * @param {ReturnType<Engine['enlargement']>} [enlargement]  of the box
 */
export function cutOf(report, enlargement = null) {
  if (!report?.cut) return null;
  if (report.cut === 'endless')
    return { text: 'The surface continues outside the box.', canEnlarge: true, canFit: false };
  if (enlargement === 'endless')
    return { text: 'The surface has no end: a larger box shows more of it.', canEnlarge: false, canFit: true };
  const of = report.border === 1 ? '1 particle lies' : `${report.border.toLocaleString('en')} particles lie`;
  return { text: `The box cuts the surface: ${of} at its border.`, canEnlarge: true, canFit: true };
}

/**
 * Returns whether the box is drawn: if the user wants it, or if the field has a surface only outside the box.
 * @param {Engine} engine
 */
export const isBoxDrawn = (engine) =>
  engine.state.value.view.box ||
  (engine.result.value === 'none' &&
    engine.field.value?.reach !== 'nowhere' &&
    engine.progress.value.stop_reason !== 'constant');

/** Doubles the box in which the surface is sampled. @param {Engine} engine */
export function enlarge(engine) {
  const bounds = engine.field.peek()?.bounds;
  if (bounds) engine.setBounds(doubled(engine.state.peek().bounds ?? bounds), { enlarges: true });
}
