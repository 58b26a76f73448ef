import { describe, expect, it } from 'vitest';
import {
  decimalsOf,
  formatCount,
  formatFixed,
  formatSeconds,
  formatShare,
  formatSignificant,
  formatStep,
  MISSING,
  plural,
  withCounts,
} from '../../../src/ui/format.js';

describe('numbers', () => {
  it('has a point and groups of three digits', () => {
    expect(formatCount(1234567)).toBe('1,234,567');
    expect(formatFixed(1234.5, 1)).toBe('1,234.5');
  });

  it('groups the counts in a sentence, and nothing else', () => {
    expect(withCounts('1382 children, near 0.12345 and 1000000. In 12 of 99999: 3.14159e-12, 2024.')).toBe(
      '1,382 children, near 0.12345 and 1,000,000. In 12 of 99,999: 3.14159e-12, 2,024.',
    );
  });

  it('writes a true minus sign and no negative zero', () => {
    expect(formatFixed(-0.25, 2)).toBe('\u22120.25');
    expect(formatFixed(-0, 2)).toBe('0.00');
    expect(formatSignificant(-3)).toBe('\u22123');
  });

  it('shows what would round to nothing as a power of ten', () => {
    expect(formatFixed(0.0000031, 3)).toBe('3.1·10⁻⁶');
    expect(formatFixed(0.0006, 3)).toBe('0.001');
    expect(formatSignificant(2.5e8)).toBe('2.5·10⁸');
  });

  it('writes a dash for what is missing and signs infinity', () => {
    for (const missing of [null, undefined, NaN, 'x']) expect(formatFixed(missing)).toBe(MISSING);
    expect(formatCount(undefined)).toBe(MISSING);
    expect(formatFixed(-Infinity)).toBe('\u2212∞');
    expect(formatSignificant(Infinity)).toBe('∞');
  });

  it('takes the decimals from the step', () => {
    expect([1, 0.1, 0.05, 0.001, 1e-4, 5].map(decimalsOf)).toEqual([0, 1, 2, 3, 4, 0]);
    expect(decimalsOf(0)).toBe(6);
    expect(formatStep(0.7000000000000001, 0.01)).toBe('0.7');
  });

  it('writes times in milliseconds below a second', () => {
    expect(formatSeconds(0.0012)).toBe('1.2\u202fms');
    expect(formatSeconds(0.212)).toBe('212\u202fms');
    expect(formatSeconds(0.99951)).toBe('1.00\u202fs');
    expect(formatSeconds(12.345)).toBe('12.35\u202fs');
  });

  it('writes shares and plurals', () => {
    expect(formatShare(0.967)).toBe('96.7%');
    expect(plural(1, 'particle')).toBe('1 particle');
    expect(plural(1463, 'particle')).toBe('1,463 particles');
  });
});
