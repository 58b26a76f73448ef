/** The picture of an image on the cutting plane. */
import { describe, expect, test } from 'vitest';
import { greysOf, lay, pixelsOf, squareTo } from '../../../src/ui/view/marks/slice-pixels.js';

const facts = /** @type {any} */ ({ histogram: Array(256).fill(100), range: [0, 256], labels: [] });
const bright = { label: null, iso: 128, is_dark_inside: false };

describe('the picture of voxels on the cutting plane', () => {
  test('is black and white at the ends of the values, but for a few of them', () => {
    const [black, white] = greysOf(facts);
    expect([black, white]).toEqual([0, 256]);
    const histogram = [...Array(128).fill(100), ...Array(127).fill(0), 1];
    expect(greysOf({ ...facts, histogram })).toEqual([0, 128]);
  });

  test('is opaque inside the surface, and transparent outside the image', () => {
    const pixels = pixelsOf([NaN, 0, 256, 64], facts, bright);
    expect(pixels[3]).toBe(0);
    expect([...pixels.slice(4, 8)]).toEqual([0, 0, 0, 115]);
    expect([...pixels.slice(8, 12)]).toEqual([255, 255, 255, 255]);
    expect([...pixels.slice(12, 15)]).toEqual([64, 64, 64]);
    const dark = pixelsOf([0, 256], facts, { ...bright, is_dark_inside: true });
    expect([dark[3], dark[7]]).toEqual([255, 115]);
  });

  test('has a colour for each label, of which the chosen one is opaque', () => {
    const labels = [0, 3, 7].map((value) => ({ value, voxels: 1 }));
    const pixels = pixelsOf([0, 3, 7], { ...facts, labels }, { label: 7, iso: 0, is_dark_inside: false });
    const colours = [0, 1, 2].map((k) => [...pixels.slice(4 * k, 4 * k + 3)].join(' '));
    expect(new Set(colours).size).toBe(3);
    expect([pixels[3], pixels[7], pixels[11]]).toEqual([60, 150, 255]);
  });

  test('is placed so that its corners lie at the spots, and only from its front', () => {
    // As seen from the front, with y down: the second side points up.
    const spots = [
      { x: 10, y: 300 },
      { x: 210, y: 280 },
      { x: 180, y: 60 },
      { x: 30, y: 90 },
    ];
    const matrix = squareTo(spots, [40, 20]);
    const m = (matrix ?? '').slice(9, -1).split(',').map(Number);
    const placed = (/** @type {number} */ x, /** @type {number} */ y) => {
      const w = m[3] * x + m[7] * y + m[15];
      return { x: (m[0] * x + m[4] * y + m[12]) / w, y: (m[1] * x + m[5] * y + m[13]) / w };
    };
    for (const [k, [x, y]] of [
      [0, 0],
      [40, 0],
      [40, 20],
      [0, 20],
    ].entries()) {
      expect(placed(x, y).x).toBeCloseTo(spots[k].x, 6);
      expect(placed(x, y).y).toBeCloseTo(spots[k].y, 6);
    }
    expect(squareTo([spots[1], spots[0], spots[3], spots[2]], [40, 20])).toBe(null);
    expect(squareTo([null, ...spots.slice(1)], [40, 20])).toBe(null);
  });

  test('is laid over a saved picture where its corners are, cut along the outline, as opaque as it is', () => {
    // Four voxels, red, green, blue and half of white, and the second side points up.
    const pixels = Uint8ClampedArray.from([255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 128]);
    const spots = [
      { x: 4, y: 36 },
      { x: 36, y: 30 },
      { x: 30, y: 8 },
      { x: 8, y: 4 },
    ];
    const image = { width: 40, height: 40, data: new Uint8ClampedArray(6400).fill(255) };
    for (let k = 0; k < 1600; k += 1) image.data.set([0, 0, 0], 4 * k);
    const outline = [spots[0], spots[1], spots[2], { x: 16, y: 6 }, { x: 7, y: 18 }];
    lay(image, { pixels, size: [2, 2] }, spots, outline);
    const at = (/** @type {number} */ x, /** @type {number} */ y) => [
      ...image.data.slice(4 * (40 * y + x), 4 * (40 * y + x) + 4),
    ];
    expect(at(8, 30)).toEqual([255, 0, 0, 255]);
    expect(at(31, 28)).toEqual([0, 255, 0, 255]);
    expect(at(12, 14), 'upper left').toEqual([0, 0, 255, 255]);
    expect(at(27, 11), 'upper right, half opaque').toEqual([128, 128, 128, 255]);
    expect(at(9, 6), 'beyond the outline').toEqual([0, 0, 0, 255]);
    expect(at(1, 1), 'beside it').toEqual([0, 0, 0, 255]);
    const before = image.data.slice();
    lay(image, { pixels, size: [2, 2] }, [...spots].reverse(), outline);
    lay(image, { pixels, size: [2, 2] }, spots, [null, ...outline]);
    expect(image.data).toEqual(before);
  });
});
