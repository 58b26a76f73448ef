/** Constants of the worker that turns points into a field and of its client. @module */

/** Largest interval between messages while the worker loads or reads. */
export const BEAT_MS = 250;
