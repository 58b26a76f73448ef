/** Neighbours of particles, and statistics of distances between them. */

/**
 * Hash of a cell. If two cells share one, some particles are compared in vain.
 * @param {number} x
 * @param {number} y
 * @param {number} z
 */
const keyOf = (x, y, z) => (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) >>> 0;

/**
 * Sorts some particles into the cells of a grid.
 * @param {ArrayLike<number>} positions
 * @param {Iterable<number>} chosen  their numbers
 * @param {number} cell  side of a cell
 */
export function createGrid(positions, chosen, cell) {
  const cellOf = (/** @type {number} */ i) => [0, 1, 2].map((k) => Math.floor(positions[3 * i + k] / cell));
  /** @type {Map<number, number[]>} */
  const cells = new Map();
  for (const i of chosen) {
    const [x, y, z] = cellOf(i);
    const list = cells.get(keyOf(x, y, z));
    if (list) list.push(i);
    else cells.set(keyOf(x, y, z), [i]);
  }
  return {
    /**
     * Yields the particles of the cells that are `ring` cells away from the cell of particle `i`.
     * @param {number} i
     * @param {number} ring
     */
    *around(i, ring) {
      const [x, y, z] = cellOf(i);
      for (let dx = -ring; dx <= ring; dx += 1)
        for (let dy = -ring; dy <= ring; dy += 1)
          for (let dz = -ring; dz <= ring; dz += 1)
            if (Math.max(Math.abs(dx), Math.abs(dy), Math.abs(dz)) === ring)
              yield* cells.get(keyOf(x + dx, y + dy, z + dz)) ?? [];
    },
  };
}

/** Distance of two particles. @param {ArrayLike<number>} p  positions @param {number} i @param {number} j */
export const between = (p, i, j) =>
  Math.hypot(p[3 * i] - p[3 * j], p[3 * i + 1] - p[3 * j + 1], p[3 * i + 2] - p[3 * j + 2]);

/** Mean, standard deviation and smallest of the finite values. @param {ArrayLike<number>} values */
export function spread(values) {
  const finite = Array.from(values).filter(Number.isFinite);
  const over = 1 / Math.max(1, finite.length);
  const mean = over * finite.reduce((sum, value) => sum + value, 0);
  const deviation = Math.sqrt(over * finite.reduce((sum, value) => sum + (value - mean) ** 2, 0));
  return { mean, deviation, least: Math.min(...finite) };
}
