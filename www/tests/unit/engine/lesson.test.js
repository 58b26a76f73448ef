import { describe, expect, test, vi } from 'vitest';
import { LessonClient, LessonError } from '../../../src/engine/lesson/client.js';
import { follow } from '../../../src/engine/lesson/follow.js';

/** @import { FromLesson, LessonProgress, ToLesson } from '../../../src/engine/lesson/types.js' */

const bounds = {
  min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
  max: /** @type {[number, number, number]} */ ([1, 1, 1]),
};
const surface = { formula: 'x^2 + y^2 + z^2 = 1', parameters: [], bounds };
/** @param {number} events @returns {LessonProgress} */
const progressOf = (events, done = false) => ({
  chapters: 1,
  events,
  particles: 1,
  evaluations: events,
  interactions: 0,
  is_capped: false,
  is_settled: false,
  steps: 0,
  is_done: done,
});

/** A bundle whose run takes `slices` slices. @param {number} slices @returns {any} */
function fakeLesson(slices) {
  let steps = 0;
  return {
    start: (/** @type {any} */ field) => {
      steps = 0;
      return field.formula.includes('bad')
        ? { ok: false, error: { kind: 'syntax', message: 'no formula' } }
        : { ok: true, ...progressOf(0) };
    },
    start_points: () => ({ ok: true, ...progressOf(0) }),
    step: () => {
      steps += 1;
      return progressOf(steps, steps === slices);
    },
    chapters: (/** @type {number} */ first) => [{ first }],
    events: (/** @type {number} */ first, /** @type {number} */ count) => [{ first, count }],
    seek: (/** @type {number} */ event) => Math.min(event, steps),
    life: () => null,
    positions: () => Float32Array.of(1, 2, 3),
    normals: () => Float32Array.of(0, 0, 1),
    radii: () => Float32Array.of(0.1),
    levels: () => Uint32Array.of(0),
    parents: () => Uint32Array.of(0xffffffff),
    fronts: () => Uint32Array.of(0),
    slots: () => Uint32Array.of(0),
    done: () => Uint8Array.of(1),
    section: () => Float32Array.of(0, 0, 1, 1),
    newton: () => [],
    digest: () => '0',
  };
}

/** A worker with a fake bundle on this thread. @param {number} slices */
function fakeWorker(slices) {
  /** @type {any} */
  const worker = { onmessage: null, onerror: null, terminate: vi.fn() };
  const follower = follow(fakeLesson(slices), {
    nowMs: () => 0,
    pause: () => new Promise((resolve) => setTimeout(resolve)),
    post: (/** @type {FromLesson} */ data) => setTimeout(() => worker.onmessage?.({ data })),
  });
  worker.postMessage = (/** @type {ToLesson} */ message) => void follower.receive(message);
  return worker;
}

/** @param {Promise<unknown>} promise @returns {Promise<LessonError>} */
const errorOf = (promise) =>
  promise.then(
    () => {
      throw new Error('not rejected');
    },
    (error) => error,
  );

describe('a lesson', () => {
  test('follows a run to its end and tells how far it is', async () => {
    const onProgress = vi.fn();
    const client = new LessonClient({ spawn: () => fakeWorker(4), onProgress });
    expect(await client.start(surface, { radius: 0.1 })).toEqual(progressOf(4, true));
    expect(onProgress.mock.calls.map(([{ events }]) => events)).toEqual([1, 2, 3]);
    expect(await client.ask('chapters', { first: 2 })).toEqual([{ first: 2 }]);
    expect(await client.ask('events', { first: 3, count: 5 })).toEqual([{ first: 3, count: 5 }]);
    expect(await client.ask('seek', { event: Infinity })).toMatchObject({ at: 4, radii: Float32Array.of(0.1) });
    expect(await client.ask('life', { particle: 9 })).toBe(null);
    const plane = { centre: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], half: 1, cells: 2 };
    expect(await client.ask('section', /** @type {any} */ (plane))).toHaveLength(4);
  });

  test('answers questions while the run goes on, and stops where it is told', async () => {
    const client = new LessonClient({ spawn: () => fakeWorker(1e9) });
    const run = client.start(surface, { radius: 0.1 });
    const { at } = await client.ask('seek', { event: Infinity });
    expect(at).toBeGreaterThan(0);
    client.stop();
    const { is_done, events } = await run;
    expect(is_done).toBe(false);
    expect(events).toBeGreaterThanOrEqual(at);
  });

  test('gives the run before up for the next one', async () => {
    const client = new LessonClient({ spawn: () => fakeWorker(8) });
    const first = errorOf(client.start(surface, { radius: 0.1 }));
    const second = client.start({ system: Uint8Array.of(1), pulls: [], bounds }, { radius: 0.2 });
    expect(await first).toMatchObject({ kind: 'given_up' });
    expect(await second).toEqual(progressOf(8, true));
  });

  test('that is refused says so in the core’s words', async () => {
    const client = new LessonClient({ spawn: () => fakeWorker(8) });
    const error = await errorOf(client.start({ ...surface, formula: 'bad' }, { radius: 0.1 }));
    expect(error).toBeInstanceOf(LessonError);
    expect(error).toMatchObject({ kind: 'refused', message: 'no formula', fault: { kind: 'syntax' } });
  });

  test('whose worker fails rejects all who wait, and the next run has another worker', async () => {
    /** @type {any[]} */
    const workers = [];
    const client = new LessonClient({
      spawn: () => {
        workers.push(fakeWorker(1e9));
        return workers.at(-1);
      },
    });
    const run = errorOf(client.start(surface, { radius: 0.1 }));
    workers[0].onmessage({ data: { type: 'crashed', message: 'unreachable', stack: '' } });
    expect(await run).toMatchObject({ kind: 'crashed', message: 'the lesson stopped on an error: unreachable' });
    expect(workers[0].terminate).toHaveBeenCalled();
    const missing = errorOf(client.start(surface, { radius: 0.1 }));
    workers[1].onerror({ message: '404' });
    expect(await missing).toMatchObject({ kind: 'bundle' });
    const closed = errorOf(client.start(surface, { radius: 0.1 }));
    client.close();
    expect(await closed).toMatchObject({ kind: 'given_up' });
    expect(workers).toHaveLength(3);
  });
});
