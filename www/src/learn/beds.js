/**
 * How deep the body must lie beneath the discs of a picture, so that it does not cut through them.
 */
import { createGrid } from '../ui/neighbours.js';

/** @import { LessonParticles } from '../engine/types.js' */
/** @typedef {Pick<LessonParticles, 'positions' | 'normals' | 'radii'>} Bedded */

/** Radius of a bed in radii of its particle, as the painter draws it. */
const BED_RADIUS = 1.75;
/** Pictures with more particles show them so small that the usual depth is enough. */
const MOST = 5000;

/**
 * The largest gap between the plane of a bed and an overlapping disc, divided by the distance of the disc's centre from
 * that plane. It is less than 1 because the disc is tilted, too.
 */
const TILT = 0.75;

/**
 * Returns for each bed how many radii deeper it must lie to cut through none of the discs that it reaches: first the
 * beds of all particles, then those of `body`. Discs may be visible from both sides. If only the first `shown`
 * particles have discs, their beds lie below the beds of the others, so that the front ends at its discs. Returns null
 * for more than {@link MOST} particles, whose beds need no extra depth.
 * @param {Bedded} particles
 * @param {number} shown  number of those that have discs
 * @param {Bedded | null} [body]
 */
export function bedDepths(particles, shown, body = null) {
  const own = particles.radii.length;
  if (own + (body?.radii.length ?? 0) > MOST || shown === 0) return null;
  const parts = body ? [particles, body] : [particles];
  const p = Float32Array.from(parts.flatMap(({ positions }) => [...positions]));
  const n = Float32Array.from(parts.flatMap(({ normals }) => [...normals]));
  const radii = Float32Array.from(parts.flatMap((part) => [...part.radii]));
  const widest = radii.reduce((most, radius) => Math.max(most, radius), 0);
  const discs = Array.from({ length: Math.min(shown, own) }, (_, j) => j);
  // A bed reaches only discs in neighbouring cells.
  const grid = createGrid(p, discs, (BED_RADIUS + 1) * widest);
  return radii.map((radius, i) => {
    let most = 0;
    for (const ring of [0, 1]) {
      for (const j of grid.around(i, ring)) {
        const [dx, dy, dz] = [0, 1, 2].map((k) => p[3 * j + k] - p[3 * i + k]);
        if (Math.hypot(dx, dy, dz) > BED_RADIUS * radius + radii[j]) continue;
        most = Math.max(most, Math.abs(dx * n[3 * i] + dy * n[3 * i + 1] + dz * n[3 * i + 2]) / radius);
      }
    }
    const isUnderOthers = i < shown && shown < radii.length;
    return (isUnderOthers ? 2 : 1) * TILT * most;
  });
}
