import { expect, it } from 'vitest';
import { borderOf } from '../../../src/ui/mesh/borders.js';
import { verdictOf } from '../../../src/ui/mesh-words.js';

/** @import { MeshAnswer } from '../../../src/engine/types.js' */

/**
 * @param {[number, number][]} components  Euler number and open edges
 * @param {Partial<MeshAnswer>} [more]
 */
const mesh = (components, more) =>
  /** @type {MeshAnswer} */ ({
    triangles: 0,
    components: components.map(([euler, open]) => ({ triangles: 0, euler, open_edges: open })),
    unfilled: 0,
    left_out: 0,
    volume: null,
    inside: null,
    smallest_angle: null,
    loops: [],
    ...more,
  });

it('a mesh is told in a line: closed or where it is open, and its topology', () => {
  expect(verdictOf(mesh([[4, 0]]))).toBe('No open edge, but not a manifold · Euler number 4');
  expect(verdictOf(mesh([[2, 0]], { volume: 4.18879, smallest_angle: 38.04 }))).toBe(
    'Watertight · Euler number 2 · volume 4.189 · smallest angle 38.0°',
  );
  expect(verdictOf(mesh([[2, 0]], { volume: 4.18879, inside: 'f < 0' }))).toBe(
    'Watertight · Euler number 2 · volume 4.189',
  );
  expect(verdictOf(mesh([[2, 0]], { volume: 4.18879, inside: 'f > 0' }))).toBe(
    'Watertight · Euler number 2 · volume 4.189 · f is larger inside; files face outward',
  );
  expect(verdictOf(mesh([[-8, 1204]]))).toBe('1,204 open edges · Euler number −8');
  expect(
    verdictOf(
      mesh(
        [
          [2, 0],
          [0, 0],
        ],
        { volume: 2 },
      ),
    ),
  ).toBe('Watertight · 2 components · Euler numbers 2, 0 · volume 2');
  expect(
    verdictOf(
      mesh([
        [1, 30],
        [1, 30],
        [1, 30],
        [2, 0],
      ]),
    ),
  ).toBe('90 open edges · 4 components · Euler numbers add up to 5');
});

it('what could not be joined is not passed over', () => {
  expect(verdictOf(mesh([[1, 6]], { unfilled: 2, left_out: 1 }))).toBe(
    '6 open edges · Euler number 1 · 2 holes where sheets meet or particles are too sparse · 1 particle left out',
  );
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
