/** What a typed formula makes of a model from points. */
import { beforeEach, describe, expect, test } from 'vitest';
import { surfaceCommands } from '../../../src/engine/commands/surface.js';
import { FILE_SURFACE, MODEL } from '../../../src/engine/constants.js';
import { createStore } from '../../../src/engine/store.js';
import { description } from './description.js';

const bounds = {
  min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
  max: /** @type {[number, number, number]} */ ([1, 1, 1]),
};

describe('a formula typed for a model', () => {
  let store = createStore();
  let { setFormula, setSurface, restore } = commands();

  function commands() {
    /** @type {any} */
    const parts = {
      store,
      sampler: { chooseTyped: () => {}, choose: () => {}, commit: () => {} },
      loader: { hasFile: true, beginning: () => ({}) },
      framing: { written: () => {}, restored: () => {} },
      picture: { viewer: { linked: null, camera: { state: store.state.value.view.camera } } },
    };
    return surfaceCommands(parts);
  }

  beforeEach(() => {
    store = createStore();
    store.description.value = description;
    ({ setFormula, setSurface, restore } = commands());
  });

  const type = (/** @type {string} */ text) => setFormula(text, { typing: true });
  const shown = () => [store.state.value.surface, store.state.value.formula];

  test('begins with its name', () => {
    setSurface('bunny');
    expect(shown()).toEqual(['bunny', MODEL]);
    setSurface('torus');
    expect(shown()).toEqual(['torus', description.surfaces[1].formula]);
  });

  test('keeps the model, its points, its box and its pulls while it names it', () => {
    setSurface('bunny');
    const pulls = [{ at: bounds.min, by: bounds.max, reach: 9 }];
    store.state.value = { ...store.state.value, centres: 120, bounds, pulls, parameters: { h: 0.2 } };
    type('max(model, z - h)');
    expect(store.state.value).toMatchObject({ surface: 'bunny', formula: 'max(model, z - h)', centres: 120 });
    expect(store.state.value).toMatchObject({ bounds, pulls, parameters: { h: 0.2 } });
  });

  test('leaves it without its name', () => {
    setSurface(FILE_SURFACE);
    store.state.value = { ...store.state.value, bounds };
    type('x^2 + y^2 = 1');
    expect(shown()).toEqual(['ellipsoid', 'x^2 + y^2 = 1']);
    expect(store.state.value.bounds).toBe(null);
  });

  test('letter by letter loses the name and has the model back with it', () => {
    setSurface(FILE_SURFACE);
    store.state.value = { ...store.state.value, centres: 300, bounds };
    for (const text of ['', 'm', 'max(', 'max(mod']) {
      type(text);
      expect(shown()).toEqual(['ellipsoid', text]);
    }
    type('max(model');
    expect(store.state.value).toMatchObject({ surface: FILE_SURFACE, formula: 'max(model', centres: 300, bounds });
  });

  test('has the name as a parameter like any other once something else was chosen', () => {
    setSurface('bunny');
    type('z');
    setSurface('torus');
    type('max(model, z)');
    expect(shown()).toEqual(['torus', 'max(model, z)']);
    const { v: _, view: __, ...shape } = store.state.value;
    setSurface('bunny');
    type('z');
    restore({ ...shape, formula: 'x' });
    type('model');
    expect(shown()).toEqual(['torus', 'model']);
  });
});
