/** What the view of the package adds to the engine: the order of what is asked for, its errors and its end. */
import { afterEach, expect, test, vi } from 'vitest';
import { createView } from '../../../package/view.js';
import { defaultState, mergeState } from '../../../src/engine/share/state.js';
import { createStore } from '../../../src/engine/store.js';
import { description } from '../engine/description.js';

/** @import { State } from '../../../src/engine/types.js' */

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
  const shown = view({ surface: 'torus', parameters: { a: 1 } });
  shown.setParameter('a', 2, { live: true });
  const set = shown.set({ formula: 'x^2 + y^2 = a', parameters: { a: 3, b: 1 } });
  shown.setParameter('b', 4);
  engine.load();
  await Promise.all([shown.ready, set]);
  expect(shown.state).toMatchObject({ surface: 'torus', formula: 'x^2 + y^2 = a', parameters: { a: 3, b: 4 } });
});

test('a change with a part that is not valid changes nothing, and names the part', async () => {
  const shown = view({ surface: 'torus' });
  engine.load();
  await shown.ready;
  const before = shown.state;
  const wrong = /** @type {any} */ ({ surface: 'ellipsoid', settings: { seed: 'x' }, view: { draw: 'lines' } });
  expect(await failed(shown.set(wrong))).toBe(
    'InputError: Not valid, and left as it was: setting seed, way of drawing.',
  );
  expect(shown.state).toEqual(before);
  await shown.set({ surface: null });
  expect(shown.state.surface).toBe('ellipsoid');
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
    engine.busy.value = true;
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
