import { describe, expect, it } from 'vitest';
import { millimetresOf, sidesOf, spanOf, thicknessOf } from '../../../src/ui/print.js';

it('lengths are read with their units', () => {
  expect(['2 mm', '0,5mm', '4cm', '2 in', ' .1 m '].map(millimetresOf)).toEqual([2, 0.5, 40, 50.8, 100]);
  for (const text of ['2', '2 m m', 'mm', '-2 mm', '0.1 + 0.05z', '2 kg', ''])
    expect(millimetresOf(text), text).toBeNull();
});

it('bodies have the box around all of them', () => {
  expect(sidesOf([])).toEqual([0, 0, 0]);
  const bodies = [
    { min: [0, 0, 0], max: [1, 2, 3] },
    { min: [-1, 0.5, 0], max: [0, 1, 4] },
  ];
  expect(sidesOf(/** @type {any} */ (bodies))).toEqual([2, 2, 4]);
});

describe('the thickness for a wall', () => {
  const box = /** @type {any} */ ({ min: [-2, -1, -1], max: [2, 1, 1] });
  const ball = (/** @type {number} */ r) => /** @type {any} */ ({ min: [-r, -r / 2, -r / 2], max: [r, r / 2, r / 2] });

  it('is in proportion where the box cuts the shell off at both ends', () => {
    expect(spanOf(box, box)).toEqual({ side: 4, free: 0 });
    expect(thicknessOf(2, 40, { side: 4, free: 0, thickness: 0 })).toBe(0.2);
  });

  it('counts that free ends move outward with it', () => {
    expect(spanOf(ball(1), box)).toEqual({ side: 2, free: 2 });
    // A shell around the unit sphere: 2 mm of 40 mm.
    const thickness = thicknessOf(2, 40, { side: 2, free: 2, thickness: 0 }) ?? 0;
    expect((thickness * 40) / (2 + thickness)).toBeCloseTo(2, 12);
    // Also from a shell that is there.
    expect(thicknessOf(2, 40, { side: 2.5, free: 2, thickness: 0.5 })).toBeCloseTo(thickness, 12);
    const half = thicknessOf(2, 40, { side: 2, free: 1, thickness: 0 }) ?? 0;
    expect((half * 40) / (2 + half / 2)).toBeCloseTo(2, 12);
  });

  it('is none for a wall that is larger than the part', () => {
    expect(thicknessOf(50, 40, { side: 2, free: 2, thickness: 0 })).toBeNull();
  });
});
