import { expect, it } from 'vitest';
import { borderOf } from '../../../src/ui/mesh/borders.js';
import { figuresOf, verdictOf } from '../../../src/ui/mesh-words.js';

/** @import { MeshAnswer } from '../../../src/engine/types.js' */

/**
 * @param {[number, number][]} components  Euler number and open edges, each a body of its own
 * @param {Partial<MeshAnswer>} [more]
 */
const mesh = (components, more) =>
  /** @type {MeshAnswer} */ ({
    triangles: 0,
    components: components.map(([euler, open], body) => ({ triangles: 0, euler, open_edges: open, body })),
    unfilled: 0,
    left_out: 0,
    volume: null,
    inside: null,
    smallest_angle: null,
    loops: [],
    bodies: components.map(() => body(1)),
    chips: [],
    ...more,
  });

/** @param {number} side @param {boolean} [isChip] @returns {MeshAnswer['bodies'][number]} */
const body = (side, isChip = false) => ({
  area: 6 * side ** 2,
  min: [0, 0, 0],
  max: [side, side, side / 2],
  volume: side ** 3,
  is_chip: isChip,
});

it('a mesh is told in a line: closed or where it is open, its parts and its size', () => {
  expect(verdictOf(mesh([[2, 0]], { volume: 1 }))).toBe('Closed · 1 part · 1\u00a0×\u00a01\u00a0×\u00a00.5');
  expect(verdictOf(mesh([[2, 0]], { volume: 1 }), { scale: 40, unit: 'mm' })).toBe(
    'Closed · 1 part · 40\u00a0×\u00a040\u00a0×\u00a020\u00a0mm',
  );
  expect(verdictOf(mesh([[4, 0]]))).toBe('No open edge, but parts touch · 1 part · 1\u00a0×\u00a01\u00a0×\u00a00.5');
  expect(verdictOf(mesh([[-8, 1204]]))).toBe('Open: 1,204 open edges · 1 part · 1\u00a0×\u00a01\u00a0×\u00a00.5');
  const bodies = [body(2), body(0.1, true), body(0.1, true)];
  const chipped = mesh(
    [
      [2, 0],
      [2, 0],
      [2, 0],
    ],
    { volume: 8, bodies },
  );
  expect(verdictOf(chipped)).toBe('Closed · 1 part and 2 loose chips · 2\u00a0×\u00a02\u00a0×\u00a01');
  // The wall of a hollow is a component, and no part.
  const hollow = mesh(
    [
      [2, 0],
      [2, 0],
    ],
    { volume: 7, bodies: [body(2)] },
  );
  expect(verdictOf(hollow)).toBe('Closed · 1 part · 2\u00a0×\u00a02\u00a0×\u00a01');
});

it('the figures of a mesh have their units, and are left out where there are none', () => {
  const one = mesh([[2, 0]], { triangles: 1200, volume: 4.18879, smallest_angle: 38.04, inside: 'f > 0' });
  expect(figuresOf(one, { scale: 10, unit: 'mm' })).toEqual([
    ['Triangles', '1,200'],
    ['Components', '1'],
    ['Euler number', '2'],
    ['Volume', '4,189\u00a0mm³'],
    ['Smallest angle', '38.0°'],
    ['Inside', 'f is larger; files face outward'],
  ]);
  const four = mesh([
    [1, 30],
    [1, 30],
    [1, 30],
    [2, 0],
  ]);
  expect(figuresOf(four)).toEqual([
    ['Triangles', '0'],
    ['Components', '4'],
    ['Sum of the Euler numbers', '5'],
  ]);
});

it('what could not be joined is not passed over', () => {
  const torn = mesh([[1, 6]], { unfilled: 2, left_out: 1 });
  expect(verdictOf(torn)).toBe(
    'Open: 6 open edges · 1 part · 1\u00a0×\u00a01\u00a0×\u00a00.5 · 2 holes where sheets meet or particles are too sparse',
  );
  expect(figuresOf(torn)).toContainEqual(['Particles left out', '1']);
  expect(verdictOf(mesh([]))).toBe('Nothing to join to a mesh');
});

it('an open border is outlined and seen from the side to which its particles face', () => {
  const columns = /** @type {any} */ ({
    positions: Float32Array.of(9, 9, 9, 1, 0, 2, 0, 1, 2, -1, 0, 2, 0, -1, 2),
    normals: Float32Array.of(1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1),
  });
  const place = borderOf({ ...mesh([[1, 5]]), loops: [[1, 2, 3, 4], [0]] }, 0, columns);
  expect(place).toMatchObject({ outline: true, radius: 1, normal: [0, 0, 1], text: '4 open edges · border 1 of 2' });
  expect(place.places).toEqual([
    [1, 0, 2],
    [0, 1, 2],
    [-1, 0, 2],
    [0, -1, 2],
  ]);
});
