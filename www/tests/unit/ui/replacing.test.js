import { signal } from '@preact/signals-core';
import { expect, it } from 'vitest';
import { createReplace } from '../../../src/ui/replacing.js';

it('what ends with a surface is named, and only that', () => {
  const state = signal(
    /** @type {any} */ ({ plane: null, bounds: null, settings: { thickness: 0.3, box_faces: 'closed' } }),
  );
  const engine = /** @type {any} */ ({
    state,
    revision: signal(0),
    field: signal(null),
    columns: { count: 0 },
    enlargement: () => null,
  });
  /** @type {string[]} */
  const told = [];
  const replace = createReplace(engine, ({ text }) => told.push(text));
  replace(() => {});
  expect(told).toEqual([]);
  replace(() => {
    state.value = { ...state.value, settings: { box_faces: 'closed' } };
  });
  replace(() => {
    state.value = { ...state.value, settings: {} };
  });
  expect(told).toEqual([
    'Ended with the surface before: thickness 0.3. Undo brings it back.',
    'Ended with the surface before: closed by the box. Undo brings it back.',
  ]);
});
