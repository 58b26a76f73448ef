import { describe, expect, test } from 'vitest';
import { captionOf, endsOf } from '../../../src/ui/picture/compose.js';
import { FILM_SIZES, sizesOf, sizeWords } from '../../../src/ui/picture/sizes.js';

describe('the sizes of a picture', () => {
  test('are those of the window, 4K and a square', () => {
    const sizes = sizesOf({ width: 1440, height: 900, ratio: 2 });
    expect(sizes.map(({ size }) => [size.width, size.height])).toEqual([
      [2880, 1800],
      [5760, 3600],
      [3840, 2160],
      [2048, 2048],
    ]);
    expect(sizeWords(sizes[2])).toBe('4K, 3840\u202f×\u202f2160');
  });

  test('keep the proportion of the window where a canvas has an end', () => {
    const { size } = sizesOf({ width: 9000, height: 3000, ratio: 1 })[1];
    expect(size).toEqual({ width: 8192, height: 2731 });
  });

  test('of a film have even sides', () => {
    for (const { size } of FILM_SIZES) expect([size.width % 2, size.height % 2]).toEqual([0, 0]);
  });
});

describe('the caption of a picture', () => {
  /** @param {object} field */
  const page = (field) =>
    /** @type {any} */ ({
      field: { peek: () => ({ surface: null, model: null, formula: '', parameters: [], ...field }) },
      description: { peek: () => ({ surfaces: [{ id: 'torus', name: 'Torus' }] }) },
      progress: { peek: () => ({ particles: 1234 }) },
    });

  test('says what is seen, its formula with the values of its parameters, and whose data it is', () => {
    const torus = page({ surface: 'torus', formula: 'x^2 +\n R = 1', parameters: [{ name: 'R', value: 1.5 }] });
    expect(captionOf(torus)).toEqual(['Torus · 1,234 particles', 'x^2 + R = 1, R = 1.5']);
    expect(captionOf(page({ formula: 'x = 0' }))).toEqual(['f(x, y, z) = 0 · 1,234 particles', 'x = 0']);
    const bunny = page({ model: { name: 'Bunny', credit: 'Stanford' } });
    expect(captionOf(bunny)).toEqual(['Bunny · 1,234 particles', 'Stanford']);
    expect(captionOf(page({ formula: 'x'.repeat(121) }))).toHaveLength(1);
  });
});

test('the ends of a scale are written as in the legend', () => {
  const legend = { title: '', unit: '', colours: Array(12).fill('#000000') };
  expect(endsOf({ ...legend, kind: 'sequential', range: [0.5, 2] })).toEqual(['0.5', '2']);
  expect(endsOf({ ...legend, kind: 'sequential', range: [2, 2] })).toEqual(['2 everywhere', '']);
  expect(endsOf({ ...legend, kind: 'diverging', range: [-1, 1] })).toEqual(['≤\u2009−1', '≥\u20091']);
});
