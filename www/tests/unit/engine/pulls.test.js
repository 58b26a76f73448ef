/** Pulls on the surface of a model: how far they go, what they leave where it is, and which are refused. */
import { expect, test } from 'vitest';
import { endOf, pullBetween } from '../../../src/engine/pulls.js';
import { validPull } from '../../../src/engine/share/state.js';
import { distance } from '../../../src/engine/vector.js';

test('a pull takes its place to where it is wanted, with the usual reach or twice its way', () => {
  const near = pullBetween([1, 0, 0], [1.25, 0, 0], { reach: 2, held: [] });
  expect(near).toEqual({ at: [1, 0, 0], by: [0.25, 0, 0], reach: 2 });
  expect(endOf(near)).toEqual([1.25, 0, 0]);
  const far = pullBetween([1, 0, 0], [1, 3, 0], { reach: 2, held: [] });
  expect(far.reach).toBeGreaterThan(6);
  expect(validPull(far)).toEqual(far);
  expect(pullBetween([1, 0, 0], [1, 0, 0], { reach: 2, held: [] }).by).toEqual([0, 0, 0]);
});

/** @import { Vec3 } from '../../../src/engine/types.js' */

test('what is held lies beyond the reach, and ends the pull before it is reached', () => {
  /** @type {Vec3[]} */
  const held = [
    [0, 0, 0],
    [9, 0, 0],
  ];
  for (const to of [0.2, 0.5, 2, 100]) {
    const pull = pullBetween([1, 0, 0], [1 + to, 0, 0], { reach: 5, held });
    expect(validPull(pull), `to ${to}`).toEqual(pull);
    for (const place of held) expect(distance(place, endOf(pull)), `to ${to}`).toBeGreaterThanOrEqual(pull.reach);
    expect(pull.by[0]).toBeCloseTo(Math.min(to, 1 / 3), 2);
  }
});

test('a pull that would tear the surface is none', () => {
  const good = { at: [0, 0, 0], by: [0, 1, 0], reach: 2 };
  expect(validPull(good)).toEqual(good);
  for (const wrong of [
    null,
    {},
    { ...good, reach: 1.9 },
    { ...good, reach: -2 },
    { ...good, reach: 0 },
    { ...good, by: [0, Number.NaN, 0] },
    { ...good, at: [0, 0] },
  ])
    expect(validPull(wrong)).toBeUndefined();
});
