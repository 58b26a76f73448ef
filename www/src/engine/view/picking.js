/**
 * Which particle lies under a point of the picture: a ray against every disc, on the processor. At 200,000 particles this is
 * one pass over two columns, about a millisecond; no second picture has to be drawn and read back.
 *
 * @module
 */

/** @typedef {import('../types.js').Vec3} Vec3 */
/** @typedef {import('../columns.js').Columns} Columns */

/**
 * Three discs around a gap of a hexagonal packing meet in its middle at this radius, relative to the particle's: so far a gap
 * belongs to the nearest of them, and not to a disc on the far side of the surface that can be seen through it.
 */
const GAP = 2 / Math.sqrt(3);
/** Where discs are smaller than this share of the particle's radius, what lies behind them is meant to be seen. */
const DENSE = 0.8;

/**
 * The nearest disc that the ray meets, or between dense discs the nearest of these; else, for discs too small to hit, the particle nearest to the ray within `tolerance`
 * (an angle, in radians).
 * @param {Columns} columns
 * @param {Vec3} eye
 * @param {Vec3} ray  length 1
 * @param {number} discScale  disc radius as a share of the particle's radius
 * @param {number} toleranceRad
 * @param {number} [lastLevel]  particles of later levels are hidden
 * @returns {number | null}
 */
export function pick(columns, eye, ray, discScale, toleranceRad, lastLevel = Infinity) {
  const { positions, normals, radii, levels, count } = columns;
  const [ex, ey, ez] = eye;
  const [dx, dy, dz] = ray;
  let hit = -1;
  let hitT = Infinity;
  let gap = -1;
  let gapCost = Infinity;
  const reachScale = discScale < DENSE ? discScale : Math.max(discScale, GAP);
  let close = -1;
  let closeCost = Infinity;
  for (let i = 0, j = 0; i < count; i += 1, j += 3) {
    const px = positions[j] - ex;
    const py = positions[j + 1] - ey;
    const pz = positions[j + 2] - ez;
    const along = px * dx + py * dy + pz * dz;
    if (along <= 0) continue;
    const offSq = px * px + py * py + pz * pz - along * along;
    const r = radii[i] * discScale;
    const rGap = radii[i] * reachScale;
    const slack = toleranceRad * along;
    const reach = Math.max(rGap, slack);
    if (offSq > reach * reach || levels[i] > lastLevel) continue;
    const nx = normals[j];
    const ny = normals[j + 1];
    const nz = normals[j + 2];
    const facing = nx * dx + ny * dy + nz * dz;
    // A disc seen exactly edge on cannot be hit.
    if (facing !== 0) {
      const t = (px * nx + py * ny + pz * nz) / facing;
      const qx = dx * t - px;
      const qy = dy * t - py;
      const qz = dz * t - pz;
      const qSq = qx * qx + qy * qy + qz * qz;
      if (t > 0 && qSq <= rGap * rGap) {
        if (t < hitT && qSq <= r * r) {
          hitT = t;
          hit = i;
        }
        // On one sheet the nearest middle counts; sheets lie farther apart than that.
        const cost = t + Math.sqrt(qSq);
        if (cost < gapCost) {
          gapCost = cost;
          gap = i;
        }
      }
    }
    // Nearer to the ray counts, and among equals nearer to the eye; a particle on the far side never wins over a near one.
    const cost = along * (1 + offSq / (slack * slack + 1e-30));
    if (offSq <= slack * slack && cost < closeCost) {
      closeCost = cost;
      close = i;
    }
  }
  // Seen flat, a disc is met far behind a gap beside it: neighbours are told by their distance.
  if (gap >= 0 && (hit < 0 || !near(columns, gap, hit))) return gap;
  if (hit >= 0) return hit;
  return close >= 0 ? close : null;
}

/** Whether two particles are no farther apart than neighbours and their neighbours. @param {Columns} columns @param {number} i @param {number} j */
function near({ positions, radii }, i, j) {
  const way = [0, 1, 2].map((k) => positions[3 * i + k] - positions[3 * j + k]);
  return Math.hypot(way[0], way[1], way[2]) <= 2 * (radii[i] + radii[j]);
}
