import { describe, expect, it } from 'vitest';
import { cutOf, doubled, wholePeriods } from '../../../src/ui/box.js';

describe('a surface that the box cuts', () => {
  it('is not spoken of where the box was chosen for the surface', () => {
    expect(cutOf(null)).toBeNull();
    expect(cutOf({ cut: null, border: 40 })).toBeNull();
  });

  it('goes on for ever, which no box fits', () => {
    expect(cutOf({ cut: 'endless', border: 40 })).toEqual({
      text: 'The surface continues outside the box.',
      canEnlarge: true,
      canFit: false,
    });
  });

  it('that has no end is not said to be held by a box that is larger still', () => {
    const { text, canEnlarge, canFit } = cutOf({ cut: 'fixed', border: 40 }, 'endless') ?? {};
    expect(text).toContain('no end');
    expect([canEnlarge, canFit]).toEqual([false, true]);
    expect(cutOf({ cut: 'fixed', border: 40 }, 'larger')?.canEnlarge).toBe(true);
  });

  it('is cut by a fixed box, and a fitted one would hold it', () => {
    expect(cutOf({ cut: 'fixed', border: 1234 })).toEqual({
      text: 'The box cuts the surface: 1,234 particles lie at its border.',
      canEnlarge: true,
      canFit: true,
    });
    expect(cutOf({ cut: 'fixed', border: 1 })?.text).toContain('1 particle lies');
  });

  it('has twice the room in a doubled box, around the same middle', () => {
    expect(doubled({ min: [-1, 0, 2], max: [1, 2, 3] })).toEqual({ min: [-2, -1, 1.5], max: [2, 3, 3.5] });
  });
});

describe('a box of whole periods', () => {
  it('has the same middle, and keeps the sides along which nothing repeats or changes', () => {
    /** @type {import('../../../src/engine/types.js').Bounds} */
    const bounds = { min: [-4, 0, -1], max: [4, 6, 1] };
    expect(wholePeriods(bounds, [2, 0, null], 3)).toEqual({ min: [-3, 0, -1], max: [3, 6, 1] });
    expect(wholePeriods(bounds, [null, 2 * Math.PI, 0.5], 1)).toEqual({
      min: [-4, 3 - Math.PI, -0.25],
      max: [4, 3 + Math.PI, 0.25],
    });
  });
});
