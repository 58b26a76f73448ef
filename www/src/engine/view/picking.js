/**
 * Finds the particle under a point of the picture by intersecting a ray with every disc or sphere on the CPU. For
 * 200,000 particles this is one pass over two columns, about a millisecond, and needs no id buffer to be drawn and read
 * back.
 *
 * @module
 */

/**
 * @import { Columns, CuttingPlane, Ray } from '../types.js'
 * @import { PickOptions } from './types.js'
 */

/**
 * Disc radius, relative to the particle's, at which three discs of a hexagonal packing meet in the gap between them.
 * Within it, a gap belongs to the nearest disc, not to a disc on the far side that is visible through the gap.
 */
const GAP = 2 / Math.sqrt(3);
/** Disc scale below which gaps are transparent, because the user wants to see through them. */
const DENSE = 0.8;

/**
 * Returns the index of the nearest disc on the ray; in a gap between dense discs, the nearest of them; for discs too
 * small to hit, the particle nearest to the ray within the angle `toleranceRad`; else null.
 * @param {Columns} columns @param {Ray} ray @param {PickOptions} options
 */
export function pick(columns, { eye, direction }, options) {
  const { discScale, spheres = false, toleranceRad, lastLevel = Infinity, plane = null } = options;
  const { shown: positions, normals, radii, levels } = columns;
  const { count } = columns;
  const [ex, ey, ez] = eye;
  const [dx, dy, dz] = direction;
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
    if (offSq > reach * reach || levels[i] > lastLevel || (plane && isBeyond(plane, positions, j))) continue;
    const nx = normals[j];
    const ny = normals[j + 1];
    const nz = normals[j + 2];
    const facing = nx * dx + ny * dy + nz * dz;
    if (spheres) {
      // NaN if the ray misses the sphere.
      const t = along - Math.sqrt(r * r - offSq);
      if (t < hitT) {
        hitT = t;
        hit = i;
      }
    } else if (facing !== 0) {
      // A disc that is exactly edge on cannot be hit.
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
        // Within a sheet the nearest centre wins. Different sheets are farther apart than this term.
        const cost = t + Math.sqrt(qSq);
        if (cost < gapCost) {
          gapCost = cost;
          gap = i;
        }
      }
    }
    // The particle nearest to the ray wins, and among equals the one nearest to the eye. A particle on the far side
    // never wins over a near one.
    const cost = along * (1 + offSq / (slack * slack + 1e-30));
    if (offSq <= slack * slack && cost < closeCost) {
      closeCost = cost;
      close = i;
    }
  }
  // At a grazing angle the ray meets a neighbouring disc far behind the gap, so neighbours are recognised by their
  // distance.
  if (gap >= 0 && (hit < 0 || !near(columns, gap, hit))) return gap;
  if (hit >= 0) return hit;
  return close >= 0 ? close : null;
}

/**
 * Whether a plane hides the point whose coordinates begin at index `at`.
 * @param {CuttingPlane} plane
 * @param {ArrayLike<number>} positions
 * @param {number} at
 */
export const isBeyond = ({ normal, offset }, positions, at) =>
  normal[0] * positions[at] + normal[1] * positions[at + 1] + normal[2] * positions[at + 2] > offset;

/**
 * Whether two particles are so near that they are at most second neighbours.
 * @param {Columns} columns
 * @param {number} i
 * @param {number} j
 */
function near({ shown: positions, radii }, i, j) {
  const way = [0, 1, 2].map((k) => positions[3 * i + k] - positions[3 * j + k]);
  return Math.hypot(way[0], way[1], way[2]) <= 2 * (radii[i] + radii[j]);
}
