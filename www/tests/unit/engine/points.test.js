import { afterEach, describe, expect, test, vi } from 'vitest';
import { LOADING_MS, SILENCE_MS } from '../../../src/engine/bundle/load.js';
import { FILE_SURFACE, MODEL } from '../../../src/engine/constants.js';
import { PointsClient } from '../../../src/engine/points/client.js';
import { ModelLoader } from '../../../src/engine/points/loader.js';
import { solve } from '../../../src/engine/points/solve.js';
import { defaultState } from '../../../src/engine/share/state.js';
import { createStore } from '../../../src/engine/store.js';
import { description } from './description.js';

/**
 * @import { FromPoints, Order, PointsLike, Solved } from '../../../src/engine/points/types.js'
 * @import { ModelInfo } from '../../../src/engine/types.js'
 */

const bounds = {
  min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
  max: /** @type {[number, number, number]} */ ([1, 1, 1]),
};
const info = /** @type {ModelInfo} */ ({
  name: 'Bunny',
  credit: 'Stanford',
  points: 200,
  centres: 200,
  condition: 1e7,
  residual_mean: 0.002,
  residual_95: 0.006,
  residual_max: 0.01,
  farthest: [0, 0, 0],
  beyond_share: 0,
  mesh: null,
  normals: 'given',
  warnings: [],
});
const solved = () =>
  /** @type {Solved} */ ({ field: Uint8Array.of(1, 2, 3), info: { info, bounds }, centres: Float32Array.of(0, 0, 1) });
const settle = () => new Promise((resolve) => setTimeout(resolve));

const stages = ['Thinning out', 'Choosing centres', 'Solving'];
const begun = { label: stages[0], fraction: 0, done: false };

/**
 * A solver in three stages that refuses names with “broken” in them.
 * @returns {PointsLike}
 */
function fakePoints() {
  let steps = 0;
  let broken = false;
  return {
    model: (/** @type {string} */ id) =>
      id === 'bunny' ? { ok: true, ...begun } : { ok: false, error: 'no such model' },
    file: (/** @type {string} */ name) => {
      broken = name.includes('broken');
      return { ok: true, ...begun };
    },
    step: () => {
      steps += 1;
      if (broken) return { ok: false, error: 'line 17: a number is missing' };
      return {
        ok: true,
        label: stages[steps - 1] ?? 'Done',
        fraction: steps / 4,
        done: steps === 4,
      };
    },
    field: () => Uint8Array.of(1, 2, 3),
    info: () => ({ ok: true, info, bounds }),
    centres: () => Float32Array.of(0, 0, 1),
  };
}
/** @param {Order} order */
async function answers(order) {
  /** @type {FromPoints[]} */
  const posted = [];
  await solve(fakePoints(), order, { nowMs: () => 0, pause: async () => {}, post: (message) => posted.push(message) });
  return posted;
}

describe('solving', () => {
  test('tells its stages and ends with the system, what is known of it and the centres', async () => {
    const posted = await answers({ model: 'bunny', centres: null });
    expect(posted.filter((m) => m.type === 'progress').map((m) => m.label)).toEqual(['Reading', ...stages]);
    expect(posted.at(-1)).toEqual({
      type: 'solved',
      solved: { field: Uint8Array.of(1, 2, 3), centres: Float32Array.of(0, 0, 1), info: { info, bounds } },
    });
  });

  test('of what is no model, no file or broken is refused in the core’s words', async () => {
    expect((await answers({ model: 'cow', centres: null })).at(-1)).toMatchObject({
      type: 'refused',
      message: 'no such model',
    });
    const file = (/** @type {string} */ name, read = async () => new ArrayBuffer(8)) =>
      /** @type {File} */ (/** @type {unknown} */ ({ name, size: 8, arrayBuffer: read }));
    expect((await answers({ file: file('broken.ply'), centres: null })).at(-1)).toMatchObject({
      type: 'refused',
      message: 'line 17: a number is missing',
    });
    expect(
      (
        await answers({
          file: file('gone.ply', async () => {
            throw new Error('NotFound');
          }),
          centres: null,
        })
      ).at(-1),
    ).toMatchObject({ type: 'refused', kind: 'unreadable' });
  });
});

/** A worker that answers when the test says so. */
function scripted() {
  /** @type {any[]} */
  const workers = [];
  const spawn = () => {
    const worker = {
      order: /** @type {any} */ (null),
      ended: false,
      onmessage: /** @type {any} */ (null),
      onerror: /** @type {any} */ (null),
      postMessage(/** @type {any} */ order) {
        worker.order = order;
      },
      terminate() {
        worker.ended = true;
      },
      say(/** @type {FromPoints} */ data) {
        worker.onmessage?.({ data });
      },
    };
    workers.push(worker);
    return worker;
  };
  return { workers, spawn };
}

describe('the client', () => {
  afterEach(() => vi.useRealTimers());
  const make = () => {
    const { workers, spawn } = scripted();
    vi.useFakeTimers();
    const client = new PointsClient({ spawn, onProgress: () => {} });
    return { workers, client };
  };

  test('keeps what was solved, and ends the worker', async () => {
    const { workers, client } = make();
    const loading = client.load('bunny', { model: 'bunny', centres: null });
    expect(workers[0].order).toEqual({ model: 'bunny', centres: null });
    workers[0].say({ type: 'solved', solved: solved() });
    expect(await loading).toHaveProperty('solved');
    expect(client.get('bunny')?.info.info.name).toBe('Bunny');
    expect(workers[0].ended).toBe(true);
    expect(vi.getTimerCount()).toBe(0);
  });

  test('gives up an order for the next one', async () => {
    const { workers, client } = make();
    const first = client.load('a', { model: 'a', centres: null });
    const second = client.load('b', { model: 'b', centres: null });
    expect(await first).toEqual({ givenUp: true });
    expect(workers.map((w) => w.ended)).toEqual([true, false]);
    client.giveUp();
    expect(await second).toEqual({ givenUp: true });
    expect(workers[1].ended).toBe(true);
  });

  test('waits long for the first word of a worker, and not long for the next', async () => {
    const { workers, client } = make();
    const ends = /** @type {string[]} */ ([]);
    const order = () => void client.load('a', { model: 'a', centres: null }).then(() => ends.push('settled'));
    order();
    await vi.advanceTimersByTimeAsync(LOADING_MS - 1);
    workers[0].say({ type: 'beat' });
    await vi.advanceTimersByTimeAsync(SILENCE_MS - 1);
    workers[0].say({ type: 'beat' });
    await vi.advanceTimersByTimeAsync(SILENCE_MS - 1);
    expect(ends).toEqual([]);
    await vi.advanceTimersByTimeAsync(5000 - SILENCE_MS);
    expect(ends).toEqual(['settled']);
    order();
    await vi.advanceTimersByTimeAsync(LOADING_MS + 1000);
    expect(ends).toEqual(['settled', 'settled']);
  });

  test('names a crash, a silence and a bundle that is not there', async () => {
    const { workers, client } = make();
    const crash = client.load('a', { model: 'a', centres: null });
    workers[0].say({ type: 'crashed', message: 'unreachable', stack: 'at wasm' });
    expect(await crash).toMatchObject({ refusal: { kind: 'crashed', details: 'unreachable\nat wasm' } });
    const silent = client.load('a', { model: 'a', centres: null });
    vi.advanceTimersByTime(LOADING_MS + 1000);
    expect(await silent).toMatchObject({ refusal: { kind: 'silent' } });
    const missing = client.load('a', { model: 'a', centres: null });
    workers[2].onerror({ message: '404' });
    expect(await missing).toMatchObject({ refusal: { kind: 'bundle', message: '404' } });
    expect(client.get('a')).toBe(undefined);
  });
});

describe('a wish for a model', () => {
  const make = (/** @type {object} */ options = {}) => {
    const { workers, spawn } = scripted();
    const store = createStore();
    store.description.value = description;
    store.state.value = defaultState(description);
    const sample = vi.fn(() => {
      expect(loader.ready()).toBe(true);
      loader.settled();
    });
    const loader = new ModelLoader({
      ...options,
      store,
      spawn,
      sample,
    });
    const wish = (/** @type {string} */ surface) => {
      store.state.value = { ...store.state.value, surface, formula: MODEL };
      return loader.load('grow');
    };
    return { workers, store, loader, sample, wish };
  };
  const file = (/** @type {string} */ name, size = 1000) =>
    /** @type {File} */ (/** @type {unknown} */ ({ name, size }));

  test('is met once it is solved, and at once the second time', async () => {
    const { workers, store, loader, sample, wish } = make();
    expect(loader.ready()).toBe(true);
    const loading = wish('bunny');
    expect(loader.ready()).toBe(false);
    expect(store.loading.value).toMatchObject({ id: 'bunny', name: 'Bunny', label: 'Starting' });
    workers[0].say({ type: 'progress', label: 'Solving', fraction: 0.5 });
    expect(store.loading.value).toMatchObject({ label: 'Solving', fraction: 0.5 });
    expect(sample).not.toHaveBeenCalled();
    workers[0].say({ type: 'solved', solved: solved() });
    await loading;
    expect(store.loading.value).toBe(null);
    expect(sample).toHaveBeenCalledTimes(1);
    store.state.value = defaultState(description);
    store.state.value = { ...store.state.value, surface: 'bunny', formula: MODEL };
    expect(loader.ready()).toBe(true);
  });

  test('that fails leaves the surface before, and says why', async () => {
    const { workers, store, loader, sample, wish } = make();
    store.state.value = { ...store.state.value, surface: 'torus', formula: 'x', parameters: { R: 2 } };
    loader.settled();
    const loading = wish('bunny');
    expect(loader.present().surface).toBe('torus');
    workers[0].say({ type: 'crashed', message: 'unreachable', stack: '' });
    await loading;
    expect(store.state.value).toMatchObject({ surface: 'torus', formula: 'x', parameters: { R: 2 } });
    expect(store.loadingError.value).toMatchObject({ id: 'bunny', kind: 'crashed' });
    expect(store.notice.value).toMatchObject({ id: 'file', kind: 'error', details: 'unreachable\n' });
    expect(sample).not.toHaveBeenCalled();
  });

  test('that fails before there is any surface leads to the standard one', async () => {
    const { workers, store, sample, wish } = make();
    const loading = wish('bunny');
    workers[0].say({ type: 'failed', message: 'no bundle' });
    await loading;
    expect(store.state.value.surface).toBe('ellipsoid');
    expect(sample).toHaveBeenCalledTimes(1);
  });

  test('with another number of centres is met as well, and leaves the number before if it is given up', async () => {
    const { workers, store, loader, sample, wish } = make();
    const loading = wish('bunny');
    workers[0].say({ type: 'solved', solved: solved() });
    await loading;
    const ask = (/** @type {number | null} */ centres) => {
      store.state.value = { ...store.state.value, centres };
      return loader.load();
    };
    const fewer = ask(120);
    expect(loader.ready()).toBe(false);
    expect(loader.present().centres).toBe(null);
    expect(workers[1].order).toEqual({ model: 'bunny', centres: 120 });
    loader.cancel();
    await fewer;
    expect(store.state.value).toMatchObject({ surface: 'bunny', centres: null });
    expect(sample).toHaveBeenCalledTimes(1);
    // The last of two wishes counts, and a wish repeated is one.
    const [one, two, same] = [ask(130), ask(140), ask(140)];
    expect(workers).toHaveLength(4);
    workers[3].say({ type: 'solved', solved: solved() });
    await Promise.all([one, two, same]);
    expect(store.state.value.centres).toBe(140);
    expect(sample).toHaveBeenCalledTimes(2);
  });

  test('with another number of centres of a file solves the same file', async () => {
    const { workers, store, loader, sample } = make();
    const opening = loader.openFile(file('cat.xyz'));
    workers[0].say({ type: 'solved', solved: solved() });
    await opening;
    store.state.value = { ...store.state.value, centres: 400 };
    const loading = loader.load();
    expect(workers[1].order).toEqual({ file: file('cat.xyz'), centres: 400 });
    workers[1].say({ type: 'solved', solved: solved() });
    await loading;
    expect(sample).toHaveBeenCalledTimes(2);
    expect(loader.ready()).toBe(true);
  });

  test('for another surface in the meantime is the one that counts', async () => {
    const { workers, store, loader, sample, wish } = make();
    const loading = wish('bunny');
    store.state.value = defaultState(description);
    loader.cancel();
    await loading;
    expect(workers[0].ended).toBe(true);
    expect(store.state.value.surface).toBe('ellipsoid');
    expect(store.loading.value).toBe(null);
    expect(sample).not.toHaveBeenCalled();
    expect(store.notice.value).toBe(null);
  });

  test('from a file enters the state when it is solved, and not before', async () => {
    const { workers, store, loader, sample } = make();
    const opening = loader.openFile(file('cat.xyz'));
    expect(store.state.value.surface).toBe('ellipsoid');
    expect(store.loading.value).toMatchObject({ id: FILE_SURFACE, name: 'cat.xyz' });
    workers[0].say({ type: 'solved', solved: solved() });
    await opening;
    expect(store.state.value).toMatchObject({ surface: FILE_SURFACE, formula: MODEL, bounds: null });
    expect(loader.hasFile).toBe(true);
    expect(sample).toHaveBeenCalledTimes(1);
    const first = loader.key();
    const again = loader.openFile(file('dog.xyz'));
    workers[1].say({ type: 'refused', kind: 'refused', message: 'line 3: NaN' });
    await again;
    expect(loader.key()).toBe(first);
    expect(store.loadingError.value).toMatchObject({ name: 'dog.xyz', message: 'line 3: NaN' });
  });

  test('from a file that is too large is not even read', async () => {
    const { workers, store, loader } = make();
    await loader.openFile(file('huge.xyz', 2e9));
    expect(workers).toHaveLength(0);
    expect(store.loadingError.value?.message).toMatch(/2[.,\s’]?000 MB.*50 MB/u);
  });

  test('from a mesh is its surface, or that of its points, as is asked, and points where it has none', async () => {
    /** @type {any[]} */
    const opened = [];
    /** @type {any} */
    let ending = { ok: true, facts: null };
    const { workers, store, loader, sample } = make({
      openGiven: async (/** @type {any} */ given) => {
        opened.push(given.as);
        return ending;
      },
    });
    await loader.openFile(file('part.stl'));
    expect(opened).toEqual(['mesh']);
    expect(workers).toHaveLength(0);
    expect(store.state.value).toMatchObject({ surface: FILE_SURFACE, formula: MODEL, parameters: {} });
    expect(store.taken.value).toBe('surface');
    expect(loader.solved(loader.key() ?? '')).toMatchObject({ file: { as: 'mesh', name: 'part.stl' } });

    const asPoints = loader.takeFor('points');
    expect(workers[0].order).toEqual({ file: file('part.stl'), centres: null });
    workers[0].say({ type: 'solved', solved: solved() });
    await asPoints;
    expect(store.taken.value).toBe('points');
    await loader.takeFor('surface');
    expect(store.taken.value).toBe('surface');
    expect(sample).toHaveBeenCalledTimes(3);

    ending = { ok: false, kind: 'no_solid', message: 'the mesh is a sheet' };
    const sheet = loader.openFile(file('leaf.obj'));
    await settle();
    workers[1].say({ type: 'solved', solved: solved() });
    await sheet;
    expect(store.taken.value).toBe(null);
    expect(store.notice.value).toMatchObject({
      kind: 'info',
      text: 'leaf.obj was taken for points: the mesh is a sheet',
    });
    expect(store.loadingError.value).toBe(null);
  });

  test('gives way to a file, and the state does not stay at what never came', async () => {
    const { workers, store, loader, sample, wish } = make();
    loader.settled();
    const loading = wish('bunny');
    const opening = loader.openFile(file('cat.xyz'));
    await loading;
    await settle();
    expect(store.state.value.surface).toBe('ellipsoid');
    expect(store.loading.value?.name).toBe('cat.xyz');
    workers[1].say({ type: 'solved', solved: solved() });
    await opening;
    expect(store.state.value.surface).toBe(FILE_SURFACE);
    expect(sample).toHaveBeenCalledTimes(1);
  });
});
