import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { classOfSlots, classOfValence, coloursOf, legendOf, rangeOf } from '../../../src/engine/view/colouring.js';
import {
  hexFromPacked,
  linear,
  oklabFromLinear,
  oklabFromPacked,
  packedFromOklab,
  rgbFromPacked,
} from '../../../src/engine/view/oklab.js';
import { COMPONENT_COLOURS, DIVERGING, PALETTES, RING } from '../../../src/engine/view/palettes.js';

// Machado, Oliveira and Fernandes (2009), severity 1, on linear sRGB.
const EYES = {
  ordinary: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protanopia: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deuteranopia: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
  tritanopia: [
    [1.255528, -0.076749, -0.178779],
    [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039],
  ],
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

  test.each([8, 55, 400])('the levels up to %i go from blue to sand, in rings by lightness', (last) => {
    const colours = palette.levels(last);
    expect(colours).toHaveLength(last + 1);
    const [, , seed] = oklabFromPacked(colours[0]);
    const [, , end] = oklabFromPacked(colours[last]);
    expect(seed).toBeLessThan(-0.05);
    expect(end).toBeGreaterThan(0.03);
    for (let level = RING; level + RING / 2 <= last; level += RING) {
      const [trough, crest] = [level, level + RING / 2].map((k) => oklabFromPacked(colours[k])[0]);
      expect(crest - trough, `level ${level}`).toBeGreaterThan(0.08);
    }
  });

  // A just noticeable difference in OKLab is about 0.02 for patches side by side.
  test.each(Object.entries(EYES))('the crest and the trough of a ring can be told apart with %s', (eye, matrix) => {
    const colours = palette.levels(80);
    for (let level = 0; level + RING / 2 <= 80; level += RING / 2)
      expect(apart(colours[level], colours[level + RING / 2], matrix), `level ${level}, ${eye}`).toBeGreaterThan(0.08);
  });

  test('half of the way from the creases is farther from blue than half of that from a seed', () => {
    const hue = (/** @type {number} */ packed) => {
      const [, a, b] = oklabFromPacked(packed);
      return (Math.atan2(b, a) * 180) / Math.PI;
    };
    expect(hue(palette.levels(16, true)[8])).toBeGreaterThan(0);
    expect(Math.abs(hue(palette.levels(16)[8]))).toBeGreaterThan(130);
    expect(palette.levels(16, true)[16]).toBe(palette.levels(16)[16]);
  });

  test('the body is darker than the discs on it, and greyer', () => {
    const [L, a, b] = oklabFromPacked(palette.body);
    for (const colour of [...palette.levels(80), palette.plain])
      expect(oklabFromPacked(colour)[0]).toBeGreaterThan(L + 0.05);
    expect(Math.hypot(a, b)).toBeLessThan(0.035);
  });

  test.each(Object.entries(EYES))('categories can be told apart with %s', (eye, matrix) => {
    for (const group of /** @type {const} */ (['valence', 'fate'])) {
      const colours = Object.entries(palette[group]);
      for (const [i, [name, colour]] of colours.entries()) {
        for (const [other, second] of colours.slice(i + 1))
          expect(apart(colour, second, matrix), `${name}, ${other}, ${eye}`).toBeGreaterThan(0.095);
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

  test.each(Object.entries(EYES))('components can be told apart with %s', (eye, matrix) => {
    expect(palette.components).toHaveLength(COMPONENT_COLOURS);
    for (let i = 0; i < COMPONENT_COLOURS; i += 1) {
      for (let j = 0; j < i; j += 1)
        expect(apart(palette.components[i], palette.components[j], matrix), `${j}, ${i}, ${eye}`).toBeGreaterThan(
          i < 6 ? 0.095 : 0.07,
        );
    }
  });

  test.each(Object.entries(EYES))(
    'the diverging ramp runs evenly away from a neutral middle with %s',
    (eye, matrix) => {
      const { diverging } = palette;
      const middle = (DIVERGING - 1) / 2;
      expect(diverging).toHaveLength(DIVERGING);
      const [, a, b] = oklabFromPacked(diverging[middle]);
      expect(Math.hypot(a, b)).toBeLessThan(0.01);
      for (const side of [-1, 1]) {
        const away = Array.from({ length: middle + 1 }, (_, k) =>
          apart(diverging[middle], diverging[middle + side * k], matrix),
        );
        // Bytes round a step by up to 0.003; equal steps of the value are equal steps for the ordinary eye.
        const step = away[middle] / middle;
        for (let k = 1; k <= middle; k += 1) {
          expect(away[k] - away[k - 1]).toBeGreaterThan(-0.004);
          if (eye === 'ordinary') expect(Math.abs(away[k] - k * step)).toBeLessThan(0.012);
        }
        expect(away[middle]).toBeGreaterThan(0.3);
      }
      for (const k of [middle / 2, middle])
        expect(apart(diverging[middle - k], diverging[middle + k], matrix)).toBeGreaterThan(k === middle ? 0.14 : 0.07);
    },
  );

  test('every colour of the data stands out from the ground', () => {
    for (const colour of [
      ...palette.levels(80),
      palette.plain,
      palette.valence.five,
      palette.valence.seven,
      palette.fate.trouble,
    ]) {
      expect(contrast(colour, palette.ground)).toBeGreaterThan(theme === 'light' ? 1.25 : 4);
    }
    // Twelve colours that are far apart, and two signs, take more of the range of lightness.
    for (const colour of [...palette.components, ...palette.diverging])
      expect(contrast(colour, palette.ground)).toBeGreaterThan(theme === 'light' ? 1.5 : 3);
  });
});

test('OKLab and back is the identity to a byte', () => {
  for (const packed of [0xff000000, 0xffffffff, 0xff336699, 0xff00ff00, 0xffabcdef])
    expect(packedFromOklab(oklabFromPacked(packed))).toBe(packed >>> 0);
  expect(hexFromPacked(0xff336699)).toBe('#996633');
});

describe('colours of particles', () => {
  const columns = new Columns();
  columns.write({
    first: 0,
    total: 3,
    positions: new Float32Array(9),
    normals: Float32Array.of(1, 0, 0, 0, -1, 0, 0, 0, 1),
    radii: Float32Array.of(0.5, 0.5, 0.5),
    levels: Uint32Array.of(0, 1, 13),
    parents: Uint32Array.of(0xffffffff, 0, 1),
  });
  const fate = (/** @type {number[]} */ ...slots) => slots.reduce((sum, f, k) => sum | (f << (3 * k)), 0);
  columns.writeSlots(0, Uint32Array.of(fate(1, 2, 3, 3, 3, 3), fate(1, 5, 3, 3, 3, 3), fate(1, 5, 4, 3, 3, 3)));

  test('by level are those of the table up to the last level, and so is the legend', () => {
    const table = PALETTES.light.levels(13);
    expect([...coloursOf('level', 'light', columns, 0, 3)]).toEqual([table[0], table[1], table[13]]);
    expect(legendOf('level', 'light', columns)).toMatchObject({
      kind: 'sequential',
      range: [0, 13],
      unit: 'rings around the seed',
      colours: [...table].map(hexFromPacked),
    });
  });

  test('by level begin at the creases, at smooth joins, at tips alone, or at a seed', () => {
    const { segments, seams, twins } = columns;
    const unit = () => legendOf('level', 'light', columns).unit;
    columns.twins = Uint32Array.of(0, 0);
    expect(unit()).toBe('rings from the tips');
    columns.segments = Uint32Array.of(0, 1);
    expect(unit()).toBe('rings from the creases');
    columns.seams = Uint32Array.of(0, 1);
    expect(unit()).toBe('rings from the creases and smooth joins');
    Object.assign(columns, { segments, seams, twins });
    expect(unit()).toBe('rings around the seed');
  });

  test('by level are rounds of blue noise, and none where points are independent; neither has slots', () => {
    const drawn = (/** @type {any} */ pattern) => Object.assign(Object.create(columns), { pattern });
    expect(legendOf('level', 'light', drawn('blue'))).toMatchObject({ range: [0, 13], unit: 'rounds of darts' });
    expect(legendOf('level', 'light', drawn('random'))).toMatchObject({
      kind: 'categories',
      unit: '',
      entries: [{ label: 'independent points: no levels' }],
      pending: false,
    });
    for (const pattern of ['blue', 'random']) {
      expect(legendOf('fate', 'light', drawn(pattern))).toMatchObject({
        entries: [{ label: 'points of a pattern: no slots' }],
        pending: false,
      });
      expect(new Set(coloursOf('fate', 'light', drawn(pattern), 0, 3)).size).toBe(1);
    }
  });

  test('by level use the last colour for levels that are newer than the range', () => {
    const table = PALETTES.dark.levels(1);
    expect([...coloursOf('level', 'dark', columns, 0, 3, [0, 1])]).toEqual([table[0], table[1], table[1]]);
  });

  test('by fate show the worst of the six slots', () => {
    expect([0, 1, 2].map((i) => classOfSlots(columns.slots[i], false))).toEqual(['interior', 'border', 'trouble']);
    expect(classOfSlots(fate(1, 0, 3, 3, 3, 3), false)).toBe('front');
    expect(classOfSlots(fate(1, 7, 5, 3, 3, 0), false)).toBe('capped');
    expect(legendOf('fate', 'dark', columns).entries?.map((e) => e.count)).toEqual([1, 1, 1]);
  });

  test('of an adaptive run know up to ten slots, of which those that are not used do not count', () => {
    expect(classOfSlots(fate(1, 2, 3, 3), true)).toBe('interior');
    expect(classOfSlots(fate(1, 2, 3, 3, 3, 3, 3, 2, 5), true)).toBe('border');
    expect(classOfSlots(fate(1, 2, 3, 3, 3, 3, 3, 2, 3, 4), true)).toBe('trouble');
    expect(classOfSlots(fate(1), true)).toBe('front');
    expect(classOfSlots(0, true)).toBe('front');
  });

  test('by figures wait for the report, and the legend says so', () => {
    expect([...coloursOf('valence', 'light', columns, 0, 3)]).toEqual(Array(3).fill(PALETTES.light.plain));
    expect(legendOf('valence', 'light', columns).pending).toBe(true);
    columns.valence = Uint8Array.of(6, 5, 9);
    columns.nearest = Float32Array.of(0.6, 1, 2);
    const { valence, sequential } = PALETTES.light;
    expect([...coloursOf('valence', 'light', columns, 0, 3)]).toEqual([valence.six, valence.five, valence.eight]);
    expect(legendOf('valence', 'light', columns).pending).toBe(false);
    expect([...coloursOf('nearest', 'light', columns, 0, 3)]).toEqual([sequential[0], sequential[42], sequential[63]]);
    expect(legendOf('nearest', 'light', columns)).toMatchObject({ kind: 'sequential', mark: 1 });
  });

  test('by nearest distance are a share of each particle’s own 2r', () => {
    const mixed = new Columns();
    mixed.write({
      first: 0,
      total: 2,
      positions: new Float32Array(6),
      normals: new Float32Array(6),
      radii: Float32Array.of(0.5, 0.1),
      levels: new Uint32Array(2),
      parents: new Uint32Array(2),
    });
    mixed.nearest = Float32Array.of(1, 0.2);
    const [large, small] = coloursOf('nearest', 'light', mixed, 0, 2);
    expect(large).toBe(small);
    expect(legendOf('nearest', 'light', mixed)).toMatchObject({ range: [0.6, 1.2], mark: 1, unit: '× 2r' });
  });

  test('by radius run from the smallest to the largest', () => {
    const mixed = new Columns();
    expect(legendOf('radius', 'light', mixed).pending).toBe(true);
    mixed.write({
      first: 0,
      total: 3,
      positions: new Float32Array(9),
      normals: new Float32Array(9),
      radii: Float32Array.of(0.5, 0.125, 0.25),
      levels: new Uint32Array(3),
      parents: new Uint32Array(3),
    });
    const { sequential } = PALETTES.dark;
    expect([...coloursOf('radius', 'dark', mixed, 0, 3)]).toEqual([sequential[63], sequential[0], sequential[21]]);
    expect(legendOf('radius', 'dark', mixed)).toMatchObject({
      kind: 'sequential',
      range: [0.125, 0.5],
      pending: false,
    });
  });

  test('by curvature have 0 in the middle of a range that a few sharp places do not widen', () => {
    const n = 1000;
    const bent = new Columns();
    bent.write({
      first: 0,
      total: n,
      positions: new Float32Array(3 * n),
      normals: new Float32Array(3 * n),
      radii: new Float32Array(n).fill(0.1),
      levels: new Uint32Array(n),
      parents: new Uint32Array(n),
    });
    expect(new Set(coloursOf('curvature', 'light', bent, 0, n))).toEqual(new Set([PALETTES.light.plain]));
    expect(legendOf('curvature', 'light', bent).pending).toBe(true);
    // Flat, saddles, bulges of 2, hollows of 1, two that are as sharp as a needle, and one without a curvature.
    const curvature = new Float32Array(2 * n);
    for (let i = 0; i < n; i += 1)
      curvature.set(
        [
          [0, 0],
          [3, -3],
          [2, 2],
          [-1, -1],
        ][i % 4],
        2 * i,
      );
    curvature.set([900, 900, -900, -900, NaN, NaN], 0);
    bent.writeCurvature(0, curvature);
    expect(rangeOf('curvature', bent)).toEqual([-2, 2]);
    const { diverging, plain } = PALETTES.light;
    const colours = coloursOf('curvature', 'light', bent, 0, n);
    expect([...colours.subarray(0, 3)]).toEqual([diverging[64], diverging[0], plain]);
    expect([...colours.subarray(4, 8)]).toEqual([diverging[32], diverging[32], diverging[64], diverging[16]]);
    expect(legendOf('curvature', 'light', bent)).toMatchObject({
      kind: 'diverging',
      range: [-2, 2],
      mark: 0,
      pending: false,
    });
  });

  test('by energy and by residual follow the figures of the report, the residual by powers of ten', () => {
    const few = new Columns();
    few.write({
      first: 0,
      total: 3,
      positions: new Float32Array(9),
      normals: new Float32Array(9),
      radii: new Float32Array(3).fill(0.1),
      levels: new Uint32Array(3),
      parents: new Uint32Array(3),
    });
    for (const mode of /** @type {const} */ (['energy', 'residual'])) {
      expect(new Set(coloursOf(mode, 'light', few, 0, 3))).toEqual(new Set([PALETTES.light.plain]));
      expect(legendOf(mode, 'light', few).pending).toBe(true);
    }
    few.writeFigures({
      valence: new Uint8Array(3).fill(6),
      nearest: new Float32Array(3),
      residual: Float32Array.of(0, 1e-6, 1),
      energy: Float32Array.of(0.2, 1, 1.4),
      component: new Uint32Array(3),
      patch: new Uint32Array(0),
      particle: new Uint32Array(0),
      periodic: new Uint32Array(0),
    });
    const ramp = PALETTES.light.sequential;
    const [first, middle, last] = [ramp[0], ramp[Math.round((ramp.length - 1) / 2)], ramp[ramp.length - 1]];
    expect([...coloursOf('energy', 'light', few, 0, 3)]).toEqual([first, middle, last]);
    const [none, some, most] = coloursOf('residual', 'light', few, 0, 3);
    expect([none, most]).toEqual([first, last]);
    expect(ramp.indexOf(some)).toBeGreaterThan(ramp.length / 3);
    expect(legendOf('energy', 'light', few)).toMatchObject({ range: [0.6, 1.4], mark: 1, pending: false });
    expect(legendOf('residual', 'light', few)).toMatchObject({ unit: '× r', pending: false });
  });

  test('by component repeat after twelve, and the legend counts the particles of each', () => {
    const many = new Columns();
    const n = 30;
    many.write({
      first: 0,
      total: n,
      positions: new Float32Array(3 * n),
      normals: new Float32Array(3 * n),
      radii: new Float32Array(n),
      levels: new Uint32Array(n),
      parents: new Uint32Array(n),
    });
    expect(legendOf('component', 'light', many).pending).toBe(true);
    many.component = Uint32Array.from({ length: n }, (_, i) => (i < 15 ? 0 : i - 14));
    many.component[29] = 0xffffffff;
    const colours = coloursOf('component', 'light', many, 0, n);
    const { components, plain } = PALETTES.light;
    expect([colours[0], colours[15], colours[26], colours[29]]).toEqual([
      components[0],
      components[1],
      components[0],
      plain,
    ]);
    const entries = legendOf('component', 'light', many).entries ?? [];
    expect(entries).toHaveLength(13);
    expect(entries[0]).toMatchObject({ label: 'component 1', count: 15 });
    expect(entries[12]).toMatchObject({ label: '3 more, in the same colours', count: 3 });
  });

  test('of a part of the particles are that part of all colours', () => {
    for (const mode of /** @type {const} */ ([
      'level',
      'fate',
      'valence',
      'nearest',
      'energy',
      'residual',
      'radius',
      'curvature',
      'component',
      'normal',
      'plain',
    ])) {
      const all = coloursOf(mode, 'dark', columns, 0, 3);
      expect([...coloursOf(mode, 'dark', columns, 1, 3)]).toEqual([...all.subarray(1)]);
      for (const colour of all) expect(colour >>> 24).toBe(255);
    }
  });

  test('classes of valence', () => {
    expect([0, 3, 4, 5, 6, 7, 8, 12, 255].map(classOfValence)).toEqual([
      'none',
      'four',
      'four',
      'five',
      'six',
      'seven',
      'eight',
      'eight',
      'eight',
    ]);
  });
});
