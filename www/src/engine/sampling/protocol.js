/**
 * Messages between the page and the sampler's worker.
 *
 * Every message about a job carries the job's id, and the page drops messages of older jobs. Columns are sent as
 * transferred buffers. The page acknowledges them after the next frame, and only then the worker sends more, so that
 * messages do not pile up if the graphics device is slow.
 *
 * @module
 */

/** Interval between progress messages of a job that sends no columns. */
export const PROGRESS_MS = 60;
/** Largest interval between messages while the worker loads or measures. */
export const BEAT_MS = 250;
