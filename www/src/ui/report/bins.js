/** Functions on the bins of a histogram. */

/** @import { Bins } from './types.js' */

/**
 * Merges bins into at most `rows` wider ones with the same counts, and removes empty bins at both ends.
 * @param {Bins} histogram
 * @param {number} rows
 */
export function coarsen({ min, max, bins }, rows) {
  const width = (max - min) / bins.length;
  let first = bins.findIndex((count) => count > 0);
  let last = bins.findLastIndex((count) => count > 0);
  if (first < 0) [first, last] = [0, -1];
  const group = Math.max(1, Math.ceil((last - first + 1) / rows));
  const result = [];
  for (let start = first; start <= last; start += group) {
    const stop = Math.min(last + 1, start + group);
    result.push({
      from: min + start * width,
      to: min + stop * width,
      count: bins.slice(start, stop).reduce((sum, count) => sum + count, 0),
    });
  }
  return result;
}

/**
 * Removes the empty bins at both ends, but keeps a small margin and the bin of the value `keep`.
 * @param {Bins} histogram
 * @param {number} keep
 * @returns {Bins}
 */
export function trim({ min, max, bins }, keep) {
  const width = (max - min) / bins.length;
  const air = 3;
  const place = Math.floor((keep - min) / width);
  const first = bins.findIndex((count) => count > 0);
  if (first < 0) return { min, max, bins };
  const last = bins.findLastIndex((count) => count > 0);
  const from = Math.max(0, Math.min(first, place) - air);
  const to = Math.min(bins.length, Math.max(last, place) + air + 1);
  return { min: min + from * width, max: min + to * width, bins: bins.slice(from, to) };
}
