/** What is said and done where the clip box cuts the surface. */

/** @typedef {import('../engine/types.js').Engine} Engine */
/** @typedef {import('../engine/types.js').Bounds} Bounds */
/** @typedef {import('../engine/types.js').Report} Report */

/** Returns a box of twice the size around the same middle. @param {Bounds} bounds @returns {Bounds} */
export function doubled({ min, max }) {
  const end = (/** @type {1 | -1} */ side) =>
    /** @type {[number, number, number]} */ (min.map((low, i) => (low + max[i]) / 2 + side * (max[i] - low)));
  return { min: end(-1), max: end(1) };
}

/**
 * Returns what is said of a surface that the box cuts, and whether a fitted box would hold it.
 * @param {Pick<Report, 'cut' | 'border'> | null} report
 * @returns {{ text: string, canFit: boolean } | null}
 */
export function cutOf(report) {
  if (!report?.cut) return null;
  if (report.cut === 'endless') return { text: 'The surface goes on beyond the box.', canFit: false };
  const of = report.border === 1 ? '1 particle lies' : `${report.border.toLocaleString('en')} particles lie`;
  return { text: `The box cuts the surface: ${of} at its border.`, canFit: true };
}

/** Doubles the box in which the surface is sampled. @param {Engine} engine */
export function enlarge(engine) {
  const bounds = engine.field.peek()?.bounds;
  if (bounds) engine.setBounds(doubled(engine.state.peek().bounds ?? bounds));
}
