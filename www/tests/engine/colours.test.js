import { describe, expect, test } from 'vitest';
import { Columns } from '../../src/engine/columns.js';
import { classOfSlots, classOfValence, coloursOf, legendOf } from '../../src/engine/view/colouring.js';
import { hexFromPacked, linear, oklabFromLinear, oklabFromPacked, packedFromOklab, rgbFromPacked } from '../../src/engine/view/oklab.js';
import { CYCLE, PALETTES } from '../../src/engine/view/palettes.js';

// Machado, Oliveira and Fernandes (2009), severity 1, on linear sRGB.
const EYES = {
  ordinary: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
};
/** @param {number} packed @param {number[][]} eye */
function seen(packed, eye) {
  const rgb = rgbFromPacked(packed).map(linear);
  const out = eye.map((row) => Math.min(1, Math.max(0, row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])));
  return oklabFromLinear(/** @type {[number, number, number]} */ (out));
}
/** @param {number} p @param {number} q @param {number[][]} eye */
function apart(p, q, eye) {
  const [a, b] = [seen(p, eye), seen(q, eye)];
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
const luminance = (/** @type {number} */ packed) => {
  const [r, g, b] = rgbFromPacked(packed).map(linear);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const contrast = (/** @type {number} */ p, /** @type {number} */ q) => {
  const [a, b] = [luminance(p), luminance(q)].sort((x, y) => y - x);
  return (a + 0.05) / (b + 0.05);
};
const themes = /** @type {const} */ (['light', 'dark']);

describe.each(themes)('the palettes, %s', (theme) => {
  const palette = PALETTES[theme];

  test('the level cycle has constant lightness', () => {
    const lightness = [...palette.levels].map((c) => oklabFromPacked(c)[0]);
    expect(palette.levels).toHaveLength(CYCLE);
    expect(Math.max(...lightness) - Math.min(...lightness)).toBeLessThan(0.006);
  });

  // A just noticeable difference in OKLab is about 0.02 for patches side by side. Tritanopia, one eye in 10,000, is near it.
  test.each(/** @type {const} */ ([['ordinary', 0.055], ['protanopia', 0.037], ['deuteranopia', 0.037], ['tritanopia', 0.013]]))(
    'neighbouring levels can be told apart with %s',
    (eye, least) => {
      for (let k = 0; k < CYCLE; k += 1) {
        expect(apart(palette.levels[k], palette.levels[(k + 1) % CYCLE], EYES[eye]), `levels ${k} and ${k + 1}`).toBeGreaterThan(least);
      }
    },
  );

  test.each(Object.entries(EYES))('categories can be told apart with %s', (eye, matrix) => {
    for (const group of /** @type {const} */ (['valence', 'fate'])) {
      const colours = Object.entries(palette[group]);
      for (const [i, [name, colour]] of colours.entries()) {
        for (const [other, second] of colours.slice(i + 1)) expect(apart(colour, second, matrix), `${name}, ${other}, ${eye}`).toBeGreaterThan(0.095);
      }
    }
  });

  test('the ramp gets lighter all the way, for every eye', () => {
    for (const eye of Object.values(EYES)) {
      const lightness = [...palette.sequential].map((c) => seen(c, eye)[0]);
      for (let i = 1; i < lightness.length; i += 1) expect(lightness[i]).toBeGreaterThan(lightness[i - 1] - 0.004);
      expect(lightness[lightness.length - 1] - lightness[0]).toBeGreaterThan(0.4);
    }
  });

  test('every colour of the data stands out from the ground', () => {
    for (const colour of [...palette.levels, palette.plain, palette.valence.five, palette.valence.seven, palette.fate.trouble]) {
      expect(contrast(colour, palette.ground)).toBeGreaterThan(theme === 'light' ? 1.6 : 4);
    }
  });
});

test('OKLab and back is the identity to a byte', () => {
  for (const packed of [0xff000000, 0xffffffff, 0xff336699, 0xff00ff00, 0xffabcdef]) expect(packedFromOklab(oklabFromPacked(packed))).toBe(packed >>> 0);
  expect(hexFromPacked(0xff336699)).toBe('#996633');
});

describe('colours of particles', () => {
  const columns = new Columns();
  columns.write({
    first: 0, total: 3, positions: new Float32Array(9), normals: Float32Array.of(1, 0, 0, 0, -1, 0, 0, 0, 1), radii: Float32Array.of(0.5, 0.5, 0.5),
    levels: Uint32Array.of(0, 1, 13), parents: Uint32Array.of(0xffffffff, 0, 1),
  });
  const fate = (/** @type {number[]} */ ...slots) => slots.reduce((sum, f, k) => sum | (f << (3 * k)), 0);
  columns.writeSlots(0, Uint32Array.of(fate(1, 2, 3, 3, 3, 3), fate(1, 5, 3, 3, 3, 3), fate(1, 5, 4, 3, 3, 3)));

  test('by level go round the cycle', () => {
    const { levels } = PALETTES.light;
    expect([...coloursOf('level', 'light', columns, 0, 3)]).toEqual([levels[0], levels[1], levels[1]]);
    expect(legendOf('level', 'light', columns)).toMatchObject({ kind: 'cyclic', range: [0, 13] });
  });

  test('by fate show the worst of the six slots', () => {
    expect([0, 1, 2].map((i) => classOfSlots(columns.slots[i]))).toEqual(['interior', 'border', 'trouble']);
    expect(classOfSlots(fate(1, 0, 3, 3, 3, 3))).toBe('front');
    expect(classOfSlots(fate(1, 7, 5, 3, 3, 0))).toBe('capped');
    expect(legendOf('fate', 'dark', columns).entries?.map((e) => e.count)).toEqual([1, 1, 1]);
  });

  test('by figures wait for the report, and the legend says so', () => {
    expect([...coloursOf('valence', 'light', columns, 0, 3)]).toEqual(Array(3).fill(PALETTES.light.plain));
    expect(legendOf('valence', 'light', columns).pending).toBe(true);
    columns.valence = Uint8Array.of(6, 5, 9);
    columns.nearest = Float32Array.of(0.6, 1, 2);
    const { valence, sequential } = PALETTES.light;
    expect([...coloursOf('valence', 'light', columns, 0, 3)]).toEqual([valence.six, valence.five, valence.eight]);
    expect(legendOf('valence', 'light', columns).pending).toBe(undefined);
    expect([...coloursOf('nearest', 'light', columns, 0, 3)]).toEqual([sequential[0], sequential[42], sequential[63]]);
    expect(legendOf('nearest', 'light', columns)).toMatchObject({ kind: 'sequential', mark: 1 });
  });

  test('of a part of the particles are that part of all colours', () => {
    for (const mode of /** @type {const} */ (['level', 'fate', 'valence', 'nearest', 'normal', 'plain'])) {
      const all = coloursOf(mode, 'dark', columns, 0, 3);
      expect([...coloursOf(mode, 'dark', columns, 1, 3)]).toEqual([...all.subarray(1)]);
      for (const colour of all) expect(colour >>> 24).toBe(255);
    }
  });

  test('classes of valence', () => {
    expect([0, 3, 4, 5, 6, 7, 8, 12, 255].map(classOfValence)).toEqual(['none', 'four', 'four', 'five', 'six', 'seven', 'eight', 'eight', 'none']);
  });
});
