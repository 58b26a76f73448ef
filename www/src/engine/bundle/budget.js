/**
 * How much of its work a worker asks of the core in one call. The core counts work, the worker measures time.
 *
 * @module
 */

/** A step of the loop should take about this long: short enough for a Stop, long enough that its overhead is lost in it. */
const STEP_MS = 6;
const LARGEST_BUDGET = 1 << 22;

/** The budget that would have taken the wanted time, changed by no more than a factor of four down and two up. */
export function nextBudget(/** @type {number} */ budget, /** @type {number} */ tookMs, targetMs = STEP_MS) {
  const factor = Math.min(2, Math.max(0.25, targetMs / Math.max(tookMs, 0.05)));
  return Math.round(Math.min(LARGEST_BUDGET, Math.max(1, budget * factor)));
}
