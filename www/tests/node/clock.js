/**
 * The clock of the page in the tests in Node. It runs as the real one does, and a test turns it on
 * instead of waiting for a silence or a pause. Workers are threads of their own, with the real one.
 *
 * @module
 */
import { vi } from 'vitest';

/** @typedef {{ act: () => void, dueMs: number, real: ReturnType<typeof setTimeout> }} Timer */

const real = {
  setTimeout: globalThis.setTimeout,
  clearTimeout: globalThis.clearTimeout,
  now: performance.now.bind(performance),
};

/** How far it is ahead of the real one. */
let aheadMs = 0;
/** @type {Map<number, Timer>} */
const timers = new Map();
let lastId = 0;

const now = () => real.now() + aheadMs;

/** @param {number} id @param {Timer} timer */
function ring(id, { act, real: handle }) {
  real.clearTimeout(handle);
  timers.delete(id);
  act();
}

vi.stubGlobal('performance', { now });
vi.stubGlobal('setTimeout', (/** @type {() => void} */ act, ms = 0) => {
  lastId += 1;
  const id = lastId;
  const wait = Math.max(1, ms);
  const handle = real.setTimeout(() => {
    const timer = timers.get(id);
    if (timer) ring(id, timer);
  }, wait);
  timers.set(id, { act, dueMs: now() + wait, real: handle });
  return id;
});
vi.stubGlobal('clearTimeout', (/** @type {number} */ id) => {
  const timer = timers.get(id);
  if (timer) real.clearTimeout(timer.real);
  timers.delete(id);
});

/** Lets what has arrived be handled: promises, and messages of the workers. */
const handled = () => new Promise((resolve) => setImmediate(resolve));

/**
 * Turns the clock on. What falls due meanwhile happens in its order, what it brings about included,
 * and messages that wait are heard before each.
 * @param {number} ms
 */
export async function turn(ms) {
  const endMs = now() + ms;
  for (;;) {
    await handled();
    let next = -1;
    for (const [id, { dueMs }] of timers)
      if (dueMs <= endMs && (next < 0 || dueMs < /** @type {Timer} */ (timers.get(next)).dueMs)) next = id;
    const timer = timers.get(next);
    if (!timer) break;
    aheadMs += Math.max(0, timer.dueMs - now());
    ring(next, timer);
  }
  aheadMs += Math.max(0, endMs - now());
  await handled();
}

/** Waits by the real clock, for work that is under way in a worker. @param {number} ms */
export const pause = (ms) => new Promise((resolve) => real.setTimeout(resolve, ms));

/** Frames come by the real clock: a clock that is turned on draws no more of them. */
export const frames = {
  ask: (/** @type {() => void} */ draw) => real.setTimeout(draw, 4),
  cancel: real.clearTimeout,
};
