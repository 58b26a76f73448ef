/** The figure of the circle: its sphere, both children and the finger that bends it. */
import { expect, test } from 'vitest';
import { bendThrough, newtonShare, slotOn } from '../../../src/learn/bend.js';

const BENDS = [0, 0.1, 0.5, 2, 8.9];
const RADIUS = 0.11;

test('the curve that is drawn has the bend, goes through p and is on f = 0', () => {
  for (const bend of BENDS) {
    const { section } = slotOn(bend, RADIUS);
    let nearest = Infinity;
    for (let k = 0; k < section.length; k += 2) {
      const [x, y] = [section[k], section[k + 1]];
      expect(y + 0.5 * bend * (x * x + y * y), `bend ${bend}`).toBeCloseTo(0, 5);
      nearest = Math.min(nearest, Math.hypot(x, y));
    }
    expect(nearest, `bend ${bend}`).toBeLessThan(1e-6);
  }
});

test('the child lies where the circle meets the sphere, at sin θ = −bend · r', () => {
  for (const bend of BENDS) {
    const [x, y] = slotOn(bend, RADIUS).child;
    expect(Math.hypot(x, y), `bend ${bend}`).toBeCloseTo(2 * RADIUS, 12);
    expect(y / (2 * RADIUS), `bend ${bend}`).toBeCloseTo(-bend * RADIUS, 12);
    expect(y + 0.5 * bend * (x * x + y * y), `bend ${bend}`).toBeCloseTo(0, 12);
  }
});

test('the surface goes through the finger that bends it', () => {
  const [x, y] = [0.18, -0.07];
  const bend = bendThrough(x, y);
  expect(y + 0.5 * bend * (x * x + y * y)).toBeCloseTo(0, 12);
  expect(bendThrough(0.2, 0)).toBeCloseTo(0, 12);
});

test('Newton’s method on the sphere lands where the curve of its error says, in the plane', () => {
  for (const bend of BENDS) {
    const { landing, aside } = slotOn(bend, RADIUS);
    expect((landing ?? 0) / (2 * RADIUS), `bend ${bend}`).toBeCloseTo(newtonShare(bend * RADIUS), 3);
    expect(aside).toBe(0);
  }
  expect(newtonShare(0)).toBe(1);
  expect(newtonShare(-0.5)).toBe(newtonShare(0.5));
});
