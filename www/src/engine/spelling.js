/** Tells how near a misspelt word is to another one. */

/**
 * The fewest slips that turn one word into another: a letter too many, one missing, a wrong one, or two neighbours in
 * the wrong order (the optimal string alignment distance).
 * @param {string} a @param {string} b
 */
export function slipsBetween(a, b) {
  /** Row i has the slips between the first i letters of `a` and the first letters of `b`. @type {number[][]} */
  const rows = [Array.from({ length: b.length + 1 }, (_, j) => j)];
  for (let i = 1; i <= a.length; i += 1) {
    const row = [i];
    for (let j = 1; j <= b.length; j += 1) {
      const wrong = rows[i - 1][j - 1] + Number(a[i - 1] !== b[j - 1]);
      row[j] = Math.min(row[j - 1] + 1, rows[i - 1][j] + 1, wrong);
      const isSwapped = i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1];
      if (isSwapped) row[j] = Math.min(row[j], rows[i - 2][j - 2] + 1);
    }
    rows.push(row);
  }
  return rows[a.length][b.length];
}
