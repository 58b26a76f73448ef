/**
 * How much is tested. The usual run is what a contributor waits for. With the variable ALL it is
 * everything, as in `cargo xtask test --all` and in continuous integration.
 *
 * A browser test that runs only then has the tag `@all`, one in Node `test.runIf(ALL)`. A test that
 * goes through a list takes a few of it, and all of it only then.
 *
 * @module
 */

export const ALL = !!process.env.ALL;

/**
 * Returns a few of a list, the same in every run: the first, the last, and others as far apart.
 * @template T
 * @param {readonly T[]} list
 * @param {number} count  at least two; how many are taken, unless everything is tested
 */
export function some(list, count) {
  if (ALL || list.length <= count) return list;
  const step = (list.length - 1) / (count - 1);
  return Array.from({ length: count }, (_, k) => list[Math.round(k * step)]);
}
