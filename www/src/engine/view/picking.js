/**
 * Which particle lies under a point of the picture: a ray against every disc, on the processor. At 200,000 particles this is
 * one pass over two columns, about a millisecond; no second picture has to be drawn and read back.
 *
 * @module
 */

/** @typedef {import('../types.js').Vec3} Vec3 */
/** @typedef {import('../columns.js').Columns} Columns */

/**
 * The nearest disc that the ray meets; else, for discs too small to hit, the particle nearest to the ray within `tolerance`
 * (an angle, in radians).
 * @param {Columns} columns
 * @param {Vec3} eye
 * @param {Vec3} ray  length 1
 * @param {number} disc_scale  disc radius as a share of the particle's radius
 * @param {number} tolerance_rad
 * @param {number} [last_level]  particles of later levels are hidden
 * @returns {number | null}
 */
export function pick(columns, eye, ray, disc_scale, tolerance_rad, last_level = Infinity) {
  const { positions, normals, radii, levels, count } = columns;
  const [ex, ey, ez] = eye;
  const [dx, dy, dz] = ray;
  let hit = -1;
  let hit_t = Infinity;
  let close = -1;
  let close_cost = Infinity;
  for (let i = 0, j = 0; i < count; i += 1, j += 3) {
    const px = positions[j] - ex;
    const py = positions[j + 1] - ey;
    const pz = positions[j + 2] - ez;
    const along = px * dx + py * dy + pz * dz;
    if (along <= 0) continue;
    const off_sq = px * px + py * py + pz * pz - along * along;
    const r = radii[i] * disc_scale;
    const slack = tolerance_rad * along;
    const reach = r > slack ? r : slack;
    if (off_sq > reach * reach || levels[i] > last_level) continue;
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
      if (t > 0 && t < hit_t && qx * qx + qy * qy + qz * qz <= r * r) {
        hit_t = t;
        hit = i;
      }
    }
    // Nearer to the ray counts, and among equals nearer to the eye; a particle on the far side never wins over a near one.
    const cost = along * (1 + off_sq / (slack * slack + 1e-30));
    if (off_sq <= slack * slack && cost < close_cost) {
      close_cost = cost;
      close = i;
    }
  }
  if (hit >= 0) return hit;
  return close >= 0 ? close : null;
}
