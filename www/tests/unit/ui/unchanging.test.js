import { expect, test } from 'vitest';
import { kindOf } from '../../../src/ui/field/unchanging.js';

/** Columns of particles by their places and normals. @param {number[][][]} particles */
const columnsOf = (particles) => ({
  positions: Float32Array.from(particles.flatMap(([place]) => place)),
  normals: Float32Array.from(particles.flatMap(([, normal]) => normal)),
  radii: new Float32Array(particles.length).fill(0.1),
  count: particles.length,
});

test('a surface without z is a plane, planes or a cylinder', () => {
  const at = (/** @type {number} */ far, /** @type {number} */ along, /** @type {number} */ sign = 1) => [
    [0.6 * far - 0.8 * along, 0.8 * far + 0.6 * along, along],
    [0.6 * sign, 0.8 * sign, 0],
  ];
  expect(kindOf(columnsOf([at(1, 0), at(1, 5), at(1, -3, -1)]))).toBe('a plane');
  expect(kindOf(columnsOf([at(1, 0), at(2, 5)]))).toBe('planes');
  const other = [
    [1, 0, 0],
    [1, 0, 0],
  ];
  expect(kindOf(columnsOf([at(1, 0), other]))).toBe('planes');
  const round = Array.from({ length: 40 }, (_, k) => [Math.cos(k / 6), Math.sin(k / 6)]);
  expect(
    kindOf(
      columnsOf(
        round.map(([x, y]) => [
          [x, y, x],
          [x, y, 0],
        ]),
      ),
    ),
  ).toBe('a cylinder');
});
