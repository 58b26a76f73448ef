/** Where the values at the ends of lines stand. */
import { expect, test, vi } from 'vitest';

// The elements that a chart is made of listen to the page.
vi.stubGlobal('addEventListener', () => {});
const { endsOf } = await import('../../../src/ui/chart.js');

/** @param {number[]} values  at the ends of the lines */
const tops = (...values) =>
  endsOf({
    kind: 'line',
    rows: values.map((value, k) => ({ fate: `fate-${k}`, name: '', counts: [0.5, value] })),
    first: 0,
    at: null,
    format: String,
    guide: [1],
  }).map(({ words, top }) => [words, +top.toFixed(3)]);

test('a value stands at its line', () => {
  expect(tops(0.9, 0.3)).toEqual([
    ['0.9', 0.154],
    ['0.3', 0.718],
  ]);
});

test('of two lines near each other the values are apart by a line of text, each as far from its own', () => {
  const [[, high], [, low]] = tops(0.584, 0.695);
  expect(Number(low) - Number(high)).toBeCloseTo(0.2);
  expect(Number(high) + Number(low)).toBeCloseTo(2 - 0.94 * (0.584 + 0.695), 2);
});

test('none leaves the chart', () => {
  expect(tops(1, 0.99, 0.98).map(([, top]) => top)).toEqual([0, 0.2, 0.4]);
});
