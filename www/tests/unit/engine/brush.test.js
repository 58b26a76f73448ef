import { describe, expect, test } from 'vitest';
import {
  canPaint,
  dabAt,
  MOST_DABS,
  painted,
  readDabs,
  spacingWith,
  without,
  withStroke,
  writeDabs,
} from '../../../src/engine/brush.js';
import { completeSettings, lastingSettings, validSetting } from '../../../src/engine/share/state.js';
import { description } from './description.js';

/** @param {number} x @param {number} [reach] @param {number} [times] */
const at = (x, reach = 0.3, times = 0.5) => dabAt([x, 0, 0], reach, times);
const BOUNDS = { min: /** @type {any} */ ([-1, -1, -1]), max: /** @type {any} */ ([1, 1, 1]) };
const DIAGONAL = Math.sqrt(12);

/** The value of a formula of the brush at a place, in JavaScript: it has no other words than these. @param {string} text */
function formulaAt(text, [x, y, z] = [0, 0, 0]) {
  const smoothstep = (/** @type {number} */ a, /** @type {number} */ b, /** @type {number} */ v) => {
    const t = Math.min(1, Math.max(0, (v - a) / (b - a)));
    return t * t * (3 - 2 * t);
  };
  const rows = text.replaceAll('^', '**').split(';');
  const code = rows.map((row, k) => {
    if (k === rows.length - 1) return `return ${row};`;
    return row.replace(/^\s*(\w+)\(([^)]*)\)=(.*)$/, 'const $1 = ($2) => $3;').replace(/^\s*(dab\d+|q)\s*=/, 'var $1=');
  });
  return Function('x', 'y', 'z', 'smoothstep', code.join('\n'))(x, y, z, smoothstep);
}

describe('what is painted', () => {
  test('is read as it was written', () => {
    const dabs = [dabAt([0.123456, -0.98765, 0], 0.3, 0.5), dabAt([1234.56789, 0, -1e-9], 0.0421, 4)];
    expect(dabs[0]).toEqual({ at: [0.123, -0.988, 0], reach: 0.3, times: 0.5 });
    expect(dabs[1].at).toEqual([1234.5679, 0, 0]);
    expect(readDabs(writeDabs(dabs))).toEqual(dabs);
    expect(readDabs('')).toEqual([]);
    expect(readDabs(undefined)).toEqual([]);
  });

  test('is refused if it is anything else', () => {
    for (const bad of [
      'x',
      '1 2 3 4',
      '1 2 3 0 2',
      '1 2 3 -1 2',
      '1 2 3 4 0',
      '1 2 3 4 99',
      '1 2 NaN 4 2',
      '1 2 3 4 2;',
      7,
    ])
      expect(readDabs(bad), String(bad)).toBe(null);
    expect(readDabs(new Array(MOST_DABS + 1).fill('0 0 0 1 2').join(';'))).toBe(null);
  });

  test('keeps its places within a fiftieth of their reach, however large or small that is', () => {
    for (const reach of [1e-6, 0.02, 0.7, 30, 5e7])
      for (const x of [0.1234567, 12.3456789, -7.654321])
        expect(Math.abs(dabAt([reach * x, 0, 0], reach, 2).at[0] - reach * x)).toBeLessThanOrEqual(reach / 50);
  });

  test('gives way to a stroke over it, and to an eraser over its middle', () => {
    const few = [at(0), at(1), at(2, 0.1)];
    expect(withStroke(few, [at(0.05, 0.3, 4)])).toEqual([at(1), at(2, 0.1), at(0.05, 0.3, 4)]);
    expect(withStroke(few, [at(0.05, 0.1)]), 'a smaller one lies over it').toHaveLength(4);
    expect(withStroke(few, [at(0.2)]), 'a line').toHaveLength(4);
    expect(without(few, [0.9, 0, 0], 0.2)).toEqual([at(0), at(2, 0.1)]);
    const many = Array.from({ length: MOST_DABS - 1 }, (_, k) => at(k));
    expect(withStroke(many, [at(-1), at(-2), at(-3)])).toEqual([...many, at(-1)]);
  });
});

describe('the formula of what is painted', () => {
  test('multiplies the spacing in the middle of a dab, and ends at its reach', () => {
    const text = spacingWith('0.02', [at(0, 0.5, 0.25), at(2, 0.5, 4)]);
    expect(formulaAt(text)).toBeCloseTo(0.005, 12);
    expect(formulaAt(text, [0, 0.2, 0])).toBeCloseTo(0.005, 12);
    expect(formulaAt(text, [2, 0, 0])).toBeCloseTo(0.08, 12);
    expect(formulaAt(text, [0, 0, 0.5])).toBeCloseTo(0.02, 12);
    expect(formulaAt(text, [9, 9, 9])).toBeCloseTo(0.02, 12);
    expect(formulaAt(text, [0, 0.4, 0])).toBeGreaterThan(0.005);
    expect(formulaAt(text, [0, 0.4, 0])).toBeLessThan(0.02);
  });

  test('has the last stroke on top, and adds nothing up along one', () => {
    expect(formulaAt(spacingWith('1', [at(0), at(0, 0.3, 4)]))).toBeCloseTo(4, 12);
    expect(formulaAt(spacingWith('1', [at(0), at(0.1), at(0.2)]), [0.1, 0, 0])).toBeCloseTo(0.5, 12);
  });

  test('keeps the definitions of a spacing, and drops its comments', () => {
    const text = spacingWith('q = 0.1; q + 0.2*x // wider to the right', [at(1)]);
    expect(formulaAt(text, [1, 0, 0])).toBeCloseTo(0.15, 12);
    expect(formulaAt(text)).toBeCloseTo(0.1, 12);
    expect(spacingWith('0.1;\n', [at(1)])).toMatch(/\(0\.1\)\*2\^dab1$/);
  });

  test('leaves room for a spacing of the user', () => {
    const dabs = Array.from({ length: MOST_DABS }, (_, k) => dabAt([-1.234 - k, -1.234, -1.234], 0.123, 0.25));
    expect(spacingWith('', dabs).length).toBeLessThan(4096 - 600);
  });

  test('is over the spacing, else over the radius, else a proportion', () => {
    const all = {
      sampling: 'uniform',
      size_mode: 'radius',
      radius_share: 0.01,
      spacing: '',
      brush: writeDabs([at(0)]),
    };
    const spacingOf = (/** @type {object} */ more) => String(painted({ ...all, ...more }, BOUNDS).spacing);
    expect(formulaAt(spacingOf({}))).toBeCloseTo(0.01 * DIAGONAL, 12);
    expect(formulaAt(spacingOf({ size_mode: 'count' }))).toBeCloseTo(0.5, 12);
    expect(formulaAt(spacingOf({ spacing: '0.3' }))).toBeCloseTo(0.15, 12);
    expect(painted(all, BOUNDS)).not.toHaveProperty('brush');
    const { brush: _, ...plain } = all;
    expect(painted(plain, BOUNDS)).toEqual(plain);
    expect(painted({ ...all, sampling: 'adaptive' }, BOUNDS), 'rests').toEqual({ ...plain, sampling: 'adaptive' });
    expect(canPaint({ sampling: 'adaptive' })).toBe(false);
    expect(canPaint({})).toBe(true);
  });
});

test('what is painted is a setting of one surface, which the core does not describe', () => {
  const brush = writeDabs([at(0)]);
  expect(validSetting(description, 'brush', brush)).toBe(brush);
  expect(validSetting(description, 'brush', 'a flower')).toBe(undefined);
  expect(completeSettings(description, { brush }).brush).toBe(brush);
  expect(completeSettings(description, {})).not.toHaveProperty('brush');
  expect(lastingSettings(description, { brush })).toEqual({});
});
