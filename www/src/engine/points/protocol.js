/** What the page and the worker that turns points into a field agree on. @module */

/** Largest interval between messages while the worker loads or reads. */
export const BEAT_MS = 250;
