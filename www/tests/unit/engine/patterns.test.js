import { expect, test } from 'vitest';
import { patternOf, unrelaxed } from '../../../src/engine/patterns.js';

test('a pattern is that of a front, unless the particles are refined', () => {
  expect(patternOf({})).toBe('hexagonal');
  expect(patternOf({ pattern: 'blue' })).toBe('blue');
  expect(patternOf({ method: 'front', pattern: 'random' })).toBe('random');
  expect(patternOf({ method: 'refined', pattern: 'random' })).toBe('hexagonal');
});

test('patterns that are drawn are not relaxed, and say why', () => {
  expect(unrelaxed('hexagonal')).toBe('');
  expect(unrelaxed('blue')).toMatch(/^Blue noise is not relaxed: /);
  expect(unrelaxed('random')).toMatch(/^Random points are not relaxed: /);
});
