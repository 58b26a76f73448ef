import { expect, it } from 'vitest';
import { meantBy } from '../../../src/ui/meant.js';

const description = /** @type {any} */ ({
  surfaces: [
    { id: 'sphere', name: 'Sphere', words: 'ball globe' },
    { id: 'torus', name: 'Torus', words: 'donut doughnut ring' },
    { id: 'double-torus', name: 'Double torus', words: 'pretzel donut' },
    { id: 'rippled', name: 'Rippled sphere', words: 'golf ball' },
    { id: 'klein', name: 'Klein bottle', words: 'one-sided' },
    { id: 'linked', name: 'Linked tori', words: 'knot chain' },
  ],
  models: [{ id: 'bunny', name: 'Bunny' }],
});
const meant = (/** @type {string} */ text) => meantBy(description, text).map(({ id }) => id);

it('words name the surfaces that have them in their names, else those that are looked for by them', () => {
  expect(meant('torus')).toEqual(['torus', 'double-torus']);
  expect(meant('Double Torus')).toEqual(['double-torus']);
  expect(meant('a klein bottle')).toEqual(['klein']);
  expect(meant('ball')).toEqual(['sphere', 'rippled']);
  expect(meant('knot')).toEqual(['linked']);
  expect(meant('sphere radius 2')).toEqual(['sphere', 'rippled']);
  expect(meant('bunny')).toEqual(['bunny']);
});

it('a formula names none, and neither do parameters and other words', () => {
  for (const text of ['torus = 1', 'x torus', 'ring^2', 'sin(ring)', 'r', 'a b', '5', '', 'hello world', '// torus'])
    expect(meant(text), text).toEqual([]);
});
