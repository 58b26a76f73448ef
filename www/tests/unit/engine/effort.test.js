import { expect, test } from 'vitest';
import { Effort } from '../../../src/engine/view/effort.js';

const WHOLE = { share: 1, body: true, stride: 1 };

/** Draws frames of a motion on a machine, and returns the time of each. */
function moved(
  /** @type {Effort} */ effort,
  /** @type {{ perPixel: number, perDisc: number }} */ machine,
  frames = 40,
) {
  return Array.from({ length: frames }, () => {
    const { share, stride } = effort.of(true);
    const ms = machine.perPixel * share * share + machine.perDisc / stride;
    effort.painted(ms);
    return ms;
  });
}

test('what is painted in motion takes a frame of 40 ms, whatever the machine and the surface', () => {
  for (const perPixel of [1, 30, 90, 200]) {
    for (const perDisc of [1, 30, 300, 1500]) {
      const effort = new Effort();
      effort.begin('canvas2d', 1);
      const times = moved(effort, { perPixel, perDisc });
      expect(Math.max(...times.slice(12)), `${perPixel} ${perDisc}`).toBeLessThan(60);
      // As much as there is time for.
      if (perPixel + perDisc < 20) expect(effort.of(true)).toEqual(WHOLE);
      expect(effort.of(false)).toEqual(WHOLE);
    }
  }
});

test('on a screen with more pixels a motion begins with those of the page', () => {
  const effort = new Effort();
  effort.begin('canvas2d', 2);
  expect(effort.of(true)).toEqual({ ...WHOLE, share: 0.5 });
  // Where there is time for them, the others come.
  moved(effort, { perPixel: 8, perDisc: 1 });
  expect(effort.of(true)).toEqual(WHOLE);
});

test('a graphics card is judged once, by the median of ten frames after the first', () => {
  const fast = Array(20).fill(16);
  const slow = Array(20).fill(120);
  const verdict = (/** @type {number[]} */ times) => {
    const effort = new Effort();
    effort.begin('webgl2', 1);
    for (const ms of times) effort.passed(ms);
    expect(effort.of(false)).toEqual(WHOLE);
    return effort.isReduced;
  };
  expect(verdict(fast)).toBe(false);
  expect(verdict(slow)).toBe(true);
  // Not by the first frame, nor by a few that were held up.
  expect(verdict([900, 16, 16, 400, 16, 16, 300, 16, 16, 500, 16])).toBe(false);
  expect(verdict(slow.slice(0, 10))).toBe(false);
  // What comes after the verdict changes nothing.
  expect(verdict([...fast, ...slow])).toBe(false);
  expect(verdict([...slow, ...fast])).toBe(true);
  const effort = new Effort();
  effort.begin('webgl2', 1);
  for (const ms of slow) effort.passed(ms);
  expect(effort.of(true)).toEqual({ share: 0.5, body: false, stride: 1 });
  // The next device is judged anew.
  effort.begin('webgl2', 1);
  expect(effort.of(true)).toEqual(WHOLE);
});
