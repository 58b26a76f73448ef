import { describe, expect, test } from 'vitest';
import { along, distance, dot } from '../../../src/engine/vector.js';
import {
  anglesOf,
  axisOf,
  directionOf,
  directionOnSphere,
  extentOf,
  niceStep,
  placeAlong,
  sectionOf,
  ticksIn,
} from '../../../src/ui/space.js';

/** @import { Bounds, Vec3 } from '../../../src/engine/types.js' */

/** @type {Bounds} */
const box = { min: [-1, -2, -3], max: [1, 2, 3] };
/** @returns {Vec3} */
const unit = (/** @type {number[]} */ v) => {
  const length = Math.hypot(...v);
  return /** @type {any} */ (v.map((c) => c / length));
};

describe('directions', () => {
  test('come back from their angles', () => {
    for (const v of [unit([1, 2, 3]), unit([-1, 0.5, -2]), unit([0, 0, -1])]) {
      const { azimuth, elevation } = anglesOf(v);
      expect(distance(directionOf(azimuth, elevation), v)).toBeLessThan(1e-12);
    }
  });

  test('are along an axis or free', () => {
    expect(axisOf([0, -1, 0])).toEqual({ axis: 1, sign: -1 });
    expect(axisOf([1e-7, 0, 1])).toEqual({ axis: 2, sign: 1 });
    expect(axisOf(unit([0, 1, 1e-3]))).toBe(null);
  });
});

describe('a plane in a box', () => {
  test('is a rectangle across an axis', () => {
    const section = sectionOf(box, { normal: [0, 0, 1], offset: 0.5 });
    expect(section).toHaveLength(4);
    for (const [x, y, z] of section) expect([Math.abs(x), Math.abs(y), z]).toEqual([1, 2, 0.5]);
    // In order around it: neighbours share a side.
    for (const [i, p] of section.entries()) expect([2, 4]).toContain(distance(p, section[(i + 1) % 4]));
  });

  test('is a hexagon across the diagonal of a cube, and nothing where it misses the box', () => {
    const cube = /** @type {typeof box} */ ({ min: [-1, -1, -1], max: [1, 1, 1] });
    const normal = unit([1, 1, 1]);
    const section = sectionOf(cube, { normal, offset: 0 });
    expect(section).toHaveLength(6);
    section.forEach((p, i) => {
      expect(dot(normal, p)).toBeCloseTo(0, 12);
      expect(distance(p, section[(i + 1) % 6])).toBeCloseTo(Math.SQRT2, 12);
    });
    expect(sectionOf(cube, { normal, offset: 2 })).toEqual([]);
  });

  test('can be moved between the extents of the box', () => {
    expect(extentOf(box, [0, 0, -1])).toEqual([-3, 3]);
    const [low, high] = extentOf({ min: [0, 0, 0], max: [1, 2, 3] }, unit([1, -1, 0]));
    expect(low).toBeCloseTo(-Math.SQRT2, 12);
    expect(high).toBeCloseTo(Math.SQRT1_2, 12);
  });
});

describe('the pointer', () => {
  test('tells how far along a line it is, unless it looks along it', () => {
    const ray = { eye: /** @type {any} */ ([5, 0.7, 3]), direction: unit([-1, 0, 0]) };
    expect(placeAlong(ray, [0, 0, 0], [0, 1, 0])).toBeCloseTo(0.7, 12);
    expect(placeAlong(ray, [0, 0, 0], [0, 0, 1])).toBeCloseTo(3, 12);
    expect(placeAlong(ray, [0, 0, 0], [1, 0, 0])).toBe(null);
    const oblique = { eye: /** @type {any} */ ([4, 4, 4]), direction: unit([-4, -4, -2]) };
    expect(placeAlong(oblique, [0, 0, 0], [0, 0, 1])).toBeCloseTo(2, 12);
  });

  test('turns a direction on the side of the sphere where it is', () => {
    const ray = { eye: /** @type {any} */ ([5, 0.6, 0]), direction: unit([-1, 0, 0]) };
    expect(distance(directionOnSphere(ray, [0, 0, 0], 1, false), [0.8, 0.6, 0])).toBeLessThan(1e-12);
    expect(distance(directionOnSphere(ray, [0, 0, 0], 1, true), [-0.8, 0.6, 0])).toBeLessThan(1e-12);
    // A ray that misses it turns the direction across the line of sight.
    const outside = { ...ray, eye: along([5, 0, 0], [0, 1, 0], 3) };
    expect(distance(directionOnSphere(outside, [0, 0, 0], 1, false), [0, 1, 0])).toBeLessThan(1e-12);
  });
});

describe('ticks', () => {
  test('are at 1, 2 and 5 times powers of ten', () => {
    expect([0.011, 0.02, 0.3, 0.6, 1, 30, 700].map(niceStep)).toEqual([0.02, 0.02, 0.5, 1, 1, 50, 1000]);
    expect([0, -1, NaN, Infinity].map(niceStep)).toEqual([1, 1, 1, 1]);
  });

  test('are multiples of the step within the range, its ends included', () => {
    expect(ticksIn(-0.31, 0.3, 0.1)).toEqual([-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3]);
    expect(ticksIn(0.1, 0.2, 1)).toEqual([]);
  });
});
