/**
 * Chooses the budget of the next call to the core. The core counts work units; the worker measures the time they take.
 *
 * @module
 */

/** Target duration of a step: short enough for a prompt Stop, long enough to make the overhead of a call negligible. */
const STEP_MS = 6;
const LARGEST_BUDGET = 1 << 22;

/** Returns the budget that would have taken `targetMs`. It changes by at most a factor of 4 down or 2 up per step. */
export function nextBudget(/** @type {number} */ budget, /** @type {number} */ tookMs, targetMs = STEP_MS) {
  const factor = Math.min(2, Math.max(0.25, targetMs / Math.max(tookMs, 0.05)));
  return Math.round(Math.min(LARGEST_BUDGET, Math.max(1, budget * factor)));
}
