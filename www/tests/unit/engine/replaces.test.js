/** When a typed text counts as another formula. */
import { expect, test } from 'vitest';
import { replaces } from '../../../src/engine/commands/surface.js';

const HEART = '(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3';

test('a text pasted or begun over another takes its place', () => {
  expect(replaces('(sqrt(x^2 + y^2) - R)^2 + z^2 = r^2', HEART)).toBe(true);
  expect(replaces(HEART, 'x')).toBe(true);
  expect(replaces(HEART, '')).toBe(true);
});

test('a formula that is edited stays the same one, key by key', () => {
  for (let end = HEART.length; end > 1; end -= 1)
    expect(replaces(HEART.slice(0, end), HEART.slice(0, end - 1))).toBe(false);
  for (let end = 0; end < HEART.length; end += 1)
    expect(replaces(HEART.slice(0, end), HEART.slice(0, end + 1))).toBe(false);
  expect(replaces('x^2 + y^2 = 1', 'x^2 + y^2 + z^2 = 1')).toBe(false);
  expect(replaces('xx', 'x')).toBe(false);
});
