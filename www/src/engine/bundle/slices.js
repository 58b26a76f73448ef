/**
 * Does long work in slices. Every loop over a bundle is this one, in the engine's workers and in the package: the
 * bundle counts units of work, the loop measures the time they take, and the thread handles messages between slices.
 *
 * @module
 */

/** @import { SliceEnv } from './types.js' */

/** Target duration of a slice: short enough for a prompt Stop, long enough to make the overhead of a call small. */
const SLICE_MS = 6;
const LARGEST_BUDGET = 1 << 22;
/** First budget, so small that the first slice is short, too. */
const FIRST_BUDGET = 32;

/** Returns the budget that would have taken `targetMs`. It changes by at most a factor of 4 down or 2 up per slice. */
export function nextBudget(/** @type {number} */ budget, /** @type {number} */ tookMs, targetMs = SLICE_MS) {
  const factor = Math.min(2, Math.max(0.25, targetMs / Math.max(tookMs, 0.05)));
  return Math.round(Math.min(LARGEST_BUDGET, Math.max(1, budget * factor)));
}

/**
 * Does work slice by slice. Returns what it made, or why it was interrupted before.
 * @template T
 * @template {string} [Why=never]
 * @param {(budget: number) => T | undefined} slice  does up to this many units; undefined before the end
 * @param {SliceEnv<Why>} env
 * @param {object} [how]
 * @param {number} [how.targetMs]
 * @param {number} [how.first]  the first budget of each phase
 * @param {() => string} [how.phase]  the phase of the next slice: each has its own budget, since units differ
 * @param {(tookMs: number) => void} [how.after]  called after each slice
 * @returns {Promise<{made: T, why: null} | {made: null, why: Why}>}
 */
export async function inSlices(slice, env, how = {}) {
  const { nowMs, pause, interrupt = () => null } = env;
  const { targetMs, first = FIRST_BUDGET, phase = () => '', after = () => {} } = how;
  /** @type {Record<string, number>} */
  const budgets = {};
  for (;;) {
    const why = interrupt();
    if (why !== null) return { made: null, why };
    const present = phase();
    const budget = budgets[present] ?? first;
    const beforeMs = nowMs();
    const made = slice(budget);
    const tookMs = nowMs() - beforeMs;
    budgets[present] = nextBudget(budget, tookMs, targetMs);
    after(tookMs);
    if (made !== undefined) return { made, why: null };
    await pause();
  }
}
