/** The laboratory of the circle: its sphere, its hand and the landings of Newton's method. */
import { expect, test } from 'vitest';
import { bracketOf, isOn, landingsOf, MOST_THETA, newtonShare, slotOn, turned } from '../../../src/learn/bend.js';

/** @import { LessonEvent } from '../../../src/engine/types.js' */

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

test('the steps of the search end where the circle meets the sphere, at sin θ = −bend · r', () => {
  for (const bend of BENDS) {
    const slot = slotOn(bend, RADIUS);
    let theta = 0;
    for (let step = 0; step < 12; step += 1) {
      const next = turned(slot, theta);
      expect(Math.abs(next - theta)).toBeLessThan((23 * Math.PI) / 180);
      theta = next;
    }
    expect(Math.sin(theta), `bend ${bend}`).toBeCloseTo(-bend * RADIUS, 6);
    expect(isOn(slot, theta)).toBe(true);
    expect(isOn(slot, theta + 0.1)).toBe(false);
  }
});

test('the hand finds the surface on its grid of half a degree, and never leaves the arc that is searched', () => {
  const slot = slotOn(8, RADIUS);
  const grid = Array.from({ length: 401 }, (_, k) => ((k - 200) / 200) * MOST_THETA);
  expect(grid.some((theta) => isOn(slot, theta))).toBe(true);
  // Without a slope there is no next angle.
  const flat = { ...slot, valueAt: () => 1 };
  expect(turned(flat, 0.3)).toBe(0.3);
  expect(turned({ ...slot, valueAt: (theta) => theta - 9 }, MOST_THETA)).toBe(MOST_THETA);
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

test('a landing has the bend of the chord, its distance, and how far it left the plane; children that met another have none', () => {
  /** @param {number} slot @param {[number, number, number]} position @param {'added' | 'matched'} fate */
  const child = (slot, position, fate) => [
    { type: 'slot', parent: 0, slot, direction: [1, 0, 0], theta_rad: 0, place: [2, 0, 0] },
    { type: 'landed', parent: 0, slot, position, normal: [0, 0, 1], distance: 2 },
    { type: 'fate', parent: 0, slot, fate, particle: 1 },
  ];
  const events = /** @type {LessonEvent[]} */ ([
    { type: 'frame', particle: 0, normal: [0, 0, 1], u: [1, 0, 0], w: [0, 1, 0], form: null },
    ...child(0, [1.2, 0, -1.6], 'added'),
    ...child(1, [1, 0.5, 0], 'added'),
    ...child(2, [2, 0, 0], 'matched'),
  ]);
  const [first, second, ...none] = landingsOf(events, Float32Array.of(0, 0, 0), 1);
  expect(first.bend).toBeCloseTo(0.8, 12);
  expect(first.share).toBeCloseTo(1, 12);
  expect(first.aside).toBe(0);
  expect(second).toMatchObject({ bend: 0, aside: 0.5 });
  expect(none).toEqual([]);
});

test('the search stays where f changes its sign, between the nearest angles that were tried', () => {
  const slot = slotOn(0.5, 1);
  expect(bracketOf(slot, [0, 0.4])).toBe(null);
  const tried = [0, -1.2, 0.4, -0.1, -0.9];
  const [from, to] = bracketOf(slot, tried) ?? [];
  expect([from, to]).toEqual([-0.9, -0.1]);
  expect(slot.valueAt(Number(from)) < 0 && slot.valueAt(Number(to)) > 0).toBe(true);
  // A flat f would send Newton's method away: the middle is next. Within the bracket it has its way.
  const flat = { ...slot, valueAt: (/** @type {number} */ theta) => theta ** 3 - 1e-3 };
  expect(turned(flat, 0, [-0.5, 0.5])).toBe(0);
  expect(turned(slot, -0.1, [-0.9, -0.1])).toBe(turned(slot, -0.1));
  expect(bracketOf({ ...slot, valueAt: () => Number.NaN }, tried)).toBe(null);
});
