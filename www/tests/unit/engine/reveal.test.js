import { expect, test } from 'vitest';
import { Reveal } from '../../../src/engine/view/reveal.js';

/** Levels of particles: one seed, then six more in each, none in the last but one; and two that fill holes. */
const FRONT = Array.from({ length: 12 }, (_, k) => (k === 10 ? [] : Array(6 * k || 1).fill(k))).flat();
const LEVELS = Uint32Array.from([...FRONT, 3, 5]);

test('the first surface waits for its front, and then appears particle by particle, level by level', () => {
  const reveal = new Reveal();
  reveal.begin(5, true);
  expect(reveal.isHeld).toBe(true);
  // All of it is uploaded at once: its body is there from the first picture on.
  expect(reveal.runs(LEVELS, 0, LEVELS.length, { nowS: 6 })).toEqual([[0, LEVELS.length, -Infinity]]);
  // However long it waits, the clock goes on.
  expect(reveal.wait(3)).toBe(0);
  reveal.release(8, LEVELS);
  expect(reveal.isHeld).toBe(false);
  let last = 0;
  for (let nowS = 8; nowS < reveal.endS() + 0.1; nowS += 0.01) {
    const shown = reveal.appeared(nowS);
    expect(shown).toBeGreaterThanOrEqual(Math.max(1, last));
    // Only of the level that appears, and of those before it.
    const level = reveal.levelAt(nowS);
    expect(LEVELS[shown - 1]).toBeLessThanOrEqual(level);
    expect(shown).toBeGreaterThanOrEqual(LEVELS.findIndex((k) => k >= level));
    if (level < 11) expect(shown).toBeLessThanOrEqual(FRONT.length);
    last = shown;
  }
  expect(last).toBe(LEVELS.length);
  reveal.end();
  expect(reveal.isOpening).toBe(false);
});

test('what of the first surface begins on the far side is there at once, and what is seen grows', () => {
  const reveal = new Reveal();
  reveal.begin(0, true);
  const first = LEVELS.indexOf(4) + 1;
  reveal.release(8, LEVELS, (i) => i === first);
  expect(reveal.births.slice(0, 5)).toEqual([8, 8, 8, 8, 8]);
  const [between] = reveal.births.slice(5).map((birthS, k) => birthS - reveal.births[4 + k]);
  expect(between).toBeGreaterThan(0);
  for (let k = 5; k < reveal.births.length; k += 1)
    expect(reveal.births[k] - reveal.births[k - 1]).toBeCloseTo(between, 9);
  expect(reveal.appeared(8)).toBe(LEVELS.indexOf(4));
  // All of it is on the far side.
  reveal.begin(8, true);
  reveal.release(9, LEVELS, () => false);
  expect(new Set(reveal.births)).toEqual(new Set([9]));
});

test('another surface appears while its front is placed', () => {
  const reveal = new Reveal();
  reveal.begin(5);
  expect(reveal.isHeld).toBe(false);
  const runs = reveal.runs(LEVELS, 0, 7, { nowS: 6 });
  expect(runs.map(([from, to]) => [from, to])).toEqual([
    [0, 1],
    [1, 7],
  ]);
  expect(runs[1][2]).toBeGreaterThan(runs[0][2]);
});
