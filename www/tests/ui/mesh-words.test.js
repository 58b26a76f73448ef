import { beforeAll, expect, it } from 'vitest';
import { setLocale } from '../../src/ui/format.js';
import { meshWords } from '../../src/ui/view/mesh-words.js';

beforeAll(() => setLocale('en'));

/**
 * @param {[number, number][]} components  Euler number and open edges
 * @param {{unfilled?: number, left_out?: number, volume?: number | null}} [more]
 */
const mesh = (components, more) => ({
  triangles: 0,
  components: components.map(([euler, open]) => ({ triangles: 0, euler, open_edges: open })),
  unfilled: 0,
  left_out: 0,
  volume: null,
  ...more,
});

it('a mesh is told in a line: closed or where it is open, and its topology', () => {
  expect(meshWords(mesh([[2, 0]]))).toBe('Closed mesh · Euler number 2');
  expect(meshWords(mesh([[2, 0]], { volume: 4.18879 }))).toBe('Closed mesh · Euler number 2 · volume 4.189');
  expect(meshWords(mesh([[-8, 1204]]))).toBe('Mesh · 1,204 open edges · Euler number −8');
  expect(
    meshWords(
      mesh([
        [2, 0],
        [0, 0],
      ]),
    ),
  ).toBe('Mesh of 2 components · closed · Euler numbers 2, 0');
  expect(
    meshWords(
      mesh([
        [1, 30],
        [1, 30],
        [1, 30],
        [2, 0],
      ]),
    ),
  ).toBe('Mesh of 4 components · 90 open edges · Euler numbers add up to 5');
});

it('what could not be joined is not passed over', () => {
  expect(meshWords(mesh([[1, 6]], { unfilled: 2, left_out: 1 }))).toBe(
    'Mesh · 6 open edges · Euler number 1 · 2 holes where sheets meet or particles are too sparse · 1 particle left out',
  );
  expect(meshWords(mesh([]))).toBe('Nothing to join to a mesh');
});
