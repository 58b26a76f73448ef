import { describe, expect, test } from 'vitest';
import { withFace } from '../../../src/ui/box.js';
import { separation } from '../../../src/ui/space.js';
import { outerEdge, outward } from '../../../src/ui/view/marks/edges.js';

/** @import { Bounds } from '../../../src/engine/types.js' */

describe('a face of the clip box', () => {
  /** @type {Bounds} */
  const box = { min: [-1, -1, -1], max: [1, 1, 1] };

  test('moves alone, to three digits of the side', () => {
    expect(withFace(box, 1, 'max', 1.23456)).toEqual({ min: [-1, -1, -1], max: [1, 1.23, 1] });
    expect(withFace(box, 2, 'min', -7.891)).toEqual({ min: [-1, -1, -7.89], max: [1, 1, 1] });
  });

  test('does not pass the opposite one', () => {
    expect(withFace(box, 0, 'max', -5).max[0]).toBeCloseTo(-0.96);
    expect(withFace(box, 0, 'min', 5).min[0]).toBeCloseTo(0.96);
  });
});

describe('figures of the box', () => {
  /** Looks down at the box from x, y, z > 0, without perspective. @type {any} */
  const engine = {
    project: (/** @type {number[]} */ [x, y, z]) => ({ x: 100 * (y - x), y: 50 * (x + y) - 100 * z, perPx: 0.01 }),
    rayThrough: () => ({ eye: [50, 50, 50], direction: [0, 0, -1] }),
  };
  /** @type {Bounds} */
  const box = { min: [0, 0, 0], max: [1, 2, 3] };

  test('stand on edges of the outline, below it and on its left', () => {
    expect(outerEdge(engine, box, 0)?.ends).toEqual([
      [0, 2, 0],
      [1, 2, 0],
    ]);
    expect(outerEdge(engine, box, 1)?.ends).toEqual([
      [1, 0, 0],
      [1, 2, 0],
    ]);
    expect(outerEdge(engine, box, 2)?.ends).toEqual([
      [1, 0, 0],
      [1, 0, 3],
    ]);
  });

  test('are outside of the edge, and are not there for a box that reaches behind the eye', () => {
    const edge = outerEdge(engine, box, 2);
    if (!edge) throw new Error('no edge');
    expect(outward(edge, edge.centre)).toMatchObject({ x: -1, anchor: 'end' });
    expect(outerEdge({ ...engine, project: () => null }, box, 2)).toBe(null);
  });
});

describe('a measured distance', () => {
  test('is straight, in units and in diameters', () => {
    const columns = /** @type {any} */ ({
      positions: Float32Array.of(0, 0, 0, 3, 4, 0),
      radii: Float32Array.of(0.5, 0.5),
      adaptive: false,
    });
    expect(separation(columns, [0, 1])).toEqual({ units: 5, diameters: 5, unit: '2r' });
    expect(separation({ ...columns, radii: Float32Array.of(0.5, 2), adaptive: true }, [0, 1]).diameters).toBe(2);
  });
});
