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
    { id: 'gyroid', name: 'Gyroid', words: 'infill foam bone' },
    { id: 'helicoid', name: 'Helicoid', words: 'screw thread spiral helix' },
    { id: 'block', name: 'Drilled block', words: 'nut part washer' },
    { id: 'barth-sextic', name: 'Barth sextic', words: 'star nodes' },
    { id: 'roman', name: 'Roman surface', words: 'steiner' },
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
  expect(meant('barth')).toEqual(['barth-sextic']);
  expect(meant('donut')).toEqual(['torus', 'double-torus']);
  expect(meant('show the screw')).toEqual(['helicoid']);
  expect(meant('nut')).toEqual(['block']);
  expect(meant('donut surface')).toEqual(['torus', 'double-torus']);
});

it('a word may be misspelt, by a letter in five', () => {
  expect(meant('torsu')).toEqual(['torus', 'double-torus']);
  expect(meant('gyriod')).toEqual(['gyroid']);
  expect(meant('giroid')).toEqual(['gyroid']);
  expect(meant('spheres')).toEqual(['sphere', 'rippled']);
  expect(meant('klien botle')).toEqual(['klein']);
  expect(meant('doughnutt')).toEqual(['torus']);
  expect(meant('screws')).toEqual(['helicoid']);
  for (const text of ['bell', 'tours de force', 'hello torsu', 'gyros', 'sphinx', 'barthelona'])
    expect(meant(text), text).toEqual([]);
});

it('search words and misspelt ones name a surface only if the text has no others', () => {
  expect(meant('golf ball')).toEqual(['rippled']);
  for (const text of ['hello world', 'knot theory', 'part of my thesis']) expect(meant(text), text).toEqual([]);
});

it('a formula names none, and neither do parameters and other words', () => {
  for (const text of ['torus = 1', 'x torus', 'ring^2', 'sin(ring)', 'r', 'a b', '5', '', 'hello world', '// torus'])
    expect(meant(text), text).toEqual([]);
});
