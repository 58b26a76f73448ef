import { describe, expect, it } from 'vitest';
import { nudge, snap, toPlace, toValue } from '../../../src/ui/scale.js';

const linear = { min: 0.2, max: 2, step: 0.01 };
const log = /** @type {const} */ ({ min: 0.001, max: 0.1, step: 0.01, scale: 'log' });
const count = /** @type {const} */ ({ min: 10, max: 1000000, step: 0.01, scale: 'log', integer: true });

describe('slider scales', () => {
  it('maps ends to ends and the middle of a logarithmic range to its geometric mean', () => {
    for (const scale of [linear, log, count]) {
      expect(toPlace(scale, scale.min)).toBe(0);
      expect(toPlace(scale, scale.max)).toBe(1);
      expect(toValue(scale, 0)).toBe(scale.min);
      expect(toValue(scale, 1)).toBe(scale.max);
    }
    expect(toValue(log, 0.5)).toBeCloseTo(0.01, 10);
  });

  it('gives back every grid value unharmed', () => {
    for (let i = 20; i <= 200; i += 1) {
      const value = Number((i / 100).toFixed(2));
      expect(toValue(linear, toPlace(linear, value))).toBe(value);
    }
  });

  it('is monotone along the whole slider', () => {
    for (const scale of [linear, log, count]) {
      let last = -Infinity;
      for (let i = 0; i <= 1000; i += 1) {
        const value = toValue(scale, i / 1000);
        expect(value).toBeGreaterThanOrEqual(last);
        last = value;
      }
    }
  });

  it('snaps ten times finer on request, and to whole numbers for integers', () => {
    expect(snap(linear, 0.70349)).toBe(0.7);
    expect(snap(linear, 0.70349, 10)).toBe(0.703);
    expect(snap(count, 1234.4)).toBe(1230);
    expect(Number.isInteger(toValue(count, 0.777, 10))).toBe(true);
  });

  it('stays within the range whatever it is given', () => {
    expect(snap(linear, 7)).toBe(2);
    expect(toValue(linear, -3)).toBe(0.2);
    expect(toPlace(linear, NaN)).toBe(0);
    expect(toPlace({ min: 1, max: 1, step: 0 }, 1)).toBe(0);
  });

  it('moves by one step per key press, finer under shift, and always moves', () => {
    expect(nudge(linear, 0.7, 1, false)).toBe(0.71);
    expect(nudge(linear, 0.7, -1, true)).toBe(0.699);
    expect(nudge(count, 20, 1, false)).toBeGreaterThan(20);
    expect(nudge(log, 0.006, 1, false)).toBeGreaterThan(0.006);
    expect(nudge(count, count.max, 1, false)).toBe(count.max);
  });
});
