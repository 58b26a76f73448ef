/**
 * A slot from the side: where the child lands on the circle, and how near its parent Newton's method lands. Lengths are
 * in the units of the surface's box; a point in the plane of the slot is (along V, along N).
 */
import { inPlane } from '../figures/geometry.js';
import { RESIDUAL } from '../figures/particle.js';
import { NoSurface } from './lab.js';

/**
 * @import { Point } from '../figures/types.js'
 * @import { SlotCase } from './types.js'
 */

const MOST_NEWTON = 30;
/** Half size of the drawn curve, in radii, and its number of parts. */
const HALF = 3.2;
const PARTS = 96;

/**
 * Distance at which Newton's method lands from its parent on a surface of constant curvature, divided by 2r. It follows
 * a gradient that points to one centre, as on a sphere.
 * @param {number} bend  times r
 */
export function newtonShare(bend) {
  if (bend === 0) return 1;
  return Math.sqrt(2 * (1 - 1 / Math.sqrt(1 + 4 * bend * bend))) / (2 * Math.abs(bend));
}

/**
 * A slot on a surface of constant curvature: a sphere through p, where f has slope 1.
 * @param {number} bend @param {number} radius  of the particle
 * @returns {SlotCase}
 */
export function slotOn(bend, radius) {
  const reach = 2 * radius;
  const value = (/** @type {Point} */ [x, y]) => y + 0.5 * bend * (x * x + y * y);
  /** @type {Point[]} */
  const newton = [[reach, 0]];
  for (let step = 0; step < MOST_NEWTON; step += 1) {
    const [x, y] = newton[step];
    const [f, gx, gy] = [value([x, y]), bend * x, 1 + bend * y];
    const squared = gx * gx + gy * gy;
    if (Math.abs(f) <= RESIDUAL * radius * Math.sqrt(squared)) break;
    newton.push([x - (f * gx) / squared, y - (f * gy) / squared]);
  }
  const landing = newton[newton.length - 1];
  const high = bend * radius;
  return {
    bend,
    radius,
    // The circle meets the sphere where sin θ = −bend · r.
    child: [reach * Math.sqrt(1 - high * high), -reach * high],
    newton: newton.slice(1),
    landing: Math.hypot(landing[0], landing[1]),
    aside: 0,
    section: sectionOn(bend, HALF * radius),
  };
}

/** A curve of constant curvature as segments, up to a distance from p. @param {number} bend @param {number} half */
function sectionOn(bend, half) {
  // Points at the angle t around the centre; a line if the curvature is 0.
  const most = bend * half < 1 ? half * 1.5 : Math.PI / bend;
  const at = (/** @type {number} */ s) =>
    bend > 0 ? [Math.sin(s * bend) / bend, (Math.cos(s * bend) - 1) / bend] : [s, 0];
  return Float32Array.from({ length: 4 * PARTS }, (_, k) => {
    const part = Math.floor(k / 4) + (k % 4 > 1 ? 1 : 0);
    return at(most * ((2 * part) / PARTS - 1))[k % 2];
  });
}

/**
 * A slot of a run.
 * @param {Awaited<ReturnType<typeof import('./measure.js').openBend>>} at  @returns {Promise<SlotCase>}
 */
export async function slotOf({ opened, whole, slot, profile }) {
  if (!profile) throw new NoSurface('Here the slot holds the parent.');
  const { place, subject } = opened;
  const { normal, direction, reach } = profile;
  const plane = { centre: place, right: direction, up: normal, radius: 1 };
  const flat = (/** @type {ArrayLike<number>} */ where) => inPlane(plane, where);
  const landed = whole.children[slot].landed;
  const child = landed ? flat(landed.position) : /** @type {Point} */ ([reach, 0]);
  return {
    bend: bendThrough(...child),
    radius: subject.radius,
    child,
    newton: profile.newton.map(({ position }) => flat(position)),
    landing: profile.newtonDistance,
    aside: profile.newtonAside * subject.radius,
    section: profile.section,
  };
}

/**
 * The curvature of the circle that touches the tangent plane at p and passes through a point.
 * @param {number} x @param {number} y
 */
export const bendThrough = (x, y) => (-2 * y) / (x * x + y * y);
