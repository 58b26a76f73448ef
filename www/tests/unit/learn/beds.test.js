/** How deep the body lies under the discs of a picture. */
import { expect, test } from 'vitest';
import { bedDepths } from '../../../src/learn/beds.js';

/**
 * Depths in radii by which the painter draws beds behind their places, and those of the surface to
 * come.
 */
const [USUAL, TO_COME] = [0.4, 0.2];

/**
 * A hexagonal patch with discs of radius 1, bent onto a sphere.
 * @param {number} bend  one over its radius
 */
function patch(bend) {
  const rows = [];
  for (let i = -4; i <= 4; i += 1) for (let j = -4; j <= 4; j += 1) rows.push([2 * i + j, j * Math.sqrt(3)]);
  const normals = rows.map(([x, y]) => {
    const way = Math.hypot(x, y);
    const across = way > 0 ? Math.sin(bend * way) / way : 0;
    return [across * x, across * y, Math.cos(bend * way)];
  });
  const positions = bend === 0 ? rows.map(([x, y]) => [x, y, 0]) : normals.map((n) => n.map((v) => v / bend));
  return {
    positions: Float32Array.from(positions.flat()),
    normals: Float32Array.from(normals.flat()),
    radii: new Float32Array(rows.length).fill(1),
  };
}

test('on a plane beds have the usual depth', () => {
  const flat = patch(0);
  expect(Math.max(...(bedDepths(flat, flat.radii.length) ?? [1]))).toBe(0);
});

test('where the surface bends, a bed lies under the discs beside it', () => {
  for (const bend of [0.1, 0.3]) {
    const dome = patch(bend);
    const middle = 40;
    const depth = USUAL + Number(bedDepths(dome, dome.radii.length)?.[middle]);
    // Where the bed ends, at 1.75 radii, and a disc beside it is: 2 radii away, and tilted.
    const [bed, disc] = [1.75, 2 - 1.75].map((way) => (bend * way ** 2) / 2);
    expect(depth).toBeGreaterThan(bed - disc);
  }
});

test('the beds of a front lie under those of the surface to come', () => {
  const bend = 0.3;
  const dome = patch(bend);
  // The middle one is the last that has a disc.
  const [shown, toCome] = Array.from(bedDepths(dome, 41) ?? []).slice(40, 42);
  expect(USUAL + shown).toBeGreaterThan(TO_COME + toCome + (bend * 1.75 ** 2) / 4);
});

test('many particles need none, and so does a picture without discs', () => {
  const radii = new Float32Array(5001);
  expect(bedDepths({ positions: new Float32Array(15_003), normals: new Float32Array(15_003), radii }, 5001)).toBe(null);
  expect(bedDepths(patch(0), 0)).toBe(null);
});
