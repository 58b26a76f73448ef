/** What the view of the package adds to the engine: the order of what is asked for, its errors and its end. */
import { afterEach, expect, test, vi } from 'vitest';
import { createView } from '../../../package/view.js';
import { defaultState, mergeState } from '../../../src/engine/share/state.js';
import { createStore } from '../../../src/engine/store.js';
import { description as cut } from '../engine/description.js';

/** @import { State } from '../../../src/engine/types.js' */

const [count] = cut.settings;
/** @param {string} name @param {string[]} values */
const choice = (name, values) => ({
  ...count,
  name,
  default: values[0],
  choices: values.map((value) => ({ value, label: value })),
});
const description = {
  ...cut,
  settings: [
    ...cut.settings,
    choice('sampling', ['uniform', 'adaptive']),
    choice('method', ['front', 'refined']),
    { ...count, name: 'seed', kind: /** @type {const} */ ('integer'), default: 0, max: 1000 },
    { ...count, name: 'spacing', kind: /** @type {const} */ ('text'), default: '' },
  ],
};

/** An engine whose core comes when it is asked for, and which samples at once or never. @type {any} */
let engine;
vi.mock('../../../src/engine/index.js', () => ({
  createEngine({ state = {} }) {
    const store = createStore();
    const take = (/** @type {State} */ now, /** @type {object} */ patch) => {
      const { state, reset } = mergeState(now, { ...patch }, description, false);
      store.state.value = state;
      return reset;
    };
    engine = {
      ...store,
      debug: { still: async () => {}, isOff: () => false },
      load() {
        store.backend.value = 'webgl2';
        store.description.value = description;
        store.progress.value = { ...store.progress.value, phase: 'done' };
        // The engine reads its first state after it has told of the core.
        void Promise.resolve()
          .then(() => {})
          .then(() => take(defaultState(description), state));
      },
      set: (/** @type {object} */ patch) => take(store.state.value, patch),
      setParameter(/** @type {string} */ name, /** @type {number} */ value) {
        take(store.state.value, { parameters: { ...store.state.value.parameters, [name]: value } });
      },
      run() {},
      stop() {},
      exportMesh: () => new Promise(() => {}),
      destroy() {},
    };
    return engine;
  },
}));
class FakeElement {
  style = {};
}
vi.stubGlobal('HTMLElement', FakeElement);
vi.stubGlobal('getComputedStyle', () => ({ position: 'static' }));

/** @param {import('../../../package/view.js').ViewState} [state] */
const view = (state) => createView(/** @type {any} */ (new FakeElement()), state);
const failed = (/** @type {Promise<unknown>} */ promise) => promise.catch(({ name, message }) => `${name}: ${message}`);

/** @type {unknown[]} */
const unhandled = [];
const heard = (/** @type {unknown} */ error) => void unhandled.push(error);
process.on('unhandledRejection', heard);
afterEach(() => {
  expect(unhandled).toEqual([]);
});

test('what is asked for before the core is there comes after the first state, in its order', async () => {
  const shown = view({ surface: 'torus', params: { a: 1 } });
  shown.setParameter('a', 2, { live: true });
  const set = shown.set({ formula: 'x^2 + y^2 = a', params: { a: 3, b: 1 } });
  shown.setParameter('b', 4);
  engine.load();
  await Promise.all([shown.ready, set]);
  expect(shown.state).toMatchObject({ surface: 'torus', formula: 'x^2 + y^2 = a', params: { a: 3, b: 4 } });
});

test('a change with a part that is not valid changes nothing, and names the part', async () => {
  const shown = view({ surface: 'torus' });
  engine.load();
  await shown.ready;
  const before = shown.state;
  const wrong = /** @type {any} */ ({ surface: 'ellipsoid', relax: 1e9, view: { draw: 'lines' } });
  expect(await failed(shown.set(wrong))).toBe('InputError: Not valid, and left as it was: relax, way of drawing.');
  expect(shown.state).toEqual(before);
  await shown.set({ surface: null });
  expect(shown.state.surface).toBe('ellipsoid');
});

test('settings are given and shown as options of sample, one size in place of another', async () => {
  const shown = view({ surface: 'torus', count: 3000, adaptive: true });
  engine.load();
  await shown.ready;
  expect(engine.state.value.settings).toEqual({ size_mode: 'count', count: 3000, sampling: 'adaptive' });
  expect(shown.state).toMatchObject({ surface: 'torus', count: 3000, adaptive: true });
  await shown.set({ radius: '1.5%', adaptive: false, method: 'refined', seed: 7 });
  expect(engine.state.value.settings).toEqual({ radius_share: 0.015, method: 'refined', seed: 7 });
  expect(shown.state).toMatchObject({ radius: '1.5%', method: 'refined', seed: 7 });
  await shown.set({ spacing: '0.1 + 0.05z', count: 500, seed: null });
  expect(shown.state).toMatchObject({ spacing: '0.1 + 0.05z', count: 500, method: 'refined' });
  expect(shown.state).not.toHaveProperty('seed');
  const { state } = shown;
  const again = view(state);
  engine.load();
  await again.ready;
  expect(again.state).toEqual(state);
});

test.each([
  ['count, radius: one of the two, not both.', { count: 5, radius: '1%' }],
  ["radius: a share of the box diagonal such as '1%' in a view, whose box changes", { radius: 0.1 }],
  ["chordError: a share of the box diagonal such as '1%' in a view", { chordError: 0.1 }],
  ['spacing: a share or a formula in a view.', { spacing: () => 1 }],
  ['count: a whole number from 1 to 4,000,000, not “x”.', { count: 'x' }],
  ['settings: there is no such entry. There are surface,', { settings: {} }],
  ['curvature_scale: there is no such entry. Did you mean curvatureScale?', { curvature_scale: 0.1 }],
])('a view refuses, before it begins and later: %s', async (words, patch) => {
  expect(() => view(/** @type {any} */ (patch))).toThrow(words);
  const shown = view();
  engine.load();
  await shown.ready;
  expect(await failed(shown.set(/** @type {any} */ (patch)))).toContain(words);
});

test('a first state that is not valid rejects what waits for it, and is told until another one is set', async () => {
  const shown = view({ surface: 'nowhere' });
  /** @type {string[]} */
  const told = [];
  shown.on('error', ({ message }) => told.push(message));
  engine.load();
  const words = 'Not valid, and replaced by defaults: surface.';
  expect(await failed(shown.ready)).toBe(`InputError: ${words}`);
  expect(told).toEqual([words]);
  await shown.set({ surface: 'torus' });
  shown.on('error', ({ message }) => told.push(message));
  await Promise.resolve();
  expect(told).toEqual([words]);
});

test.each([false, true])('what is waited for is rejected at the end; the core had come: %s', async (hasCome) => {
  const shown = view();
  if (hasCome) {
    engine.load();
    await shown.ready;
    engine.status.value = 'sampling';
  }
  const waiting = [shown.set({ surface: 'torus' }), shown.run(), shown.toFile('glb'), shown.stop()];
  if (!hasCome) waiting.push(shown.ready);
  shown.setParameter('a', 2);
  shown.destroy();
  waiting.push(shown.run());
  for (const outcome of await Promise.all(waiting.map(failed)))
    expect(outcome).toBe('DisposedError: The view was destroyed.');
});

test('a view that ends before anyone looks at it leaves no error behind', async () => {
  view().destroy();
  await new Promise((resolve) => setTimeout(resolve, 20));
});
