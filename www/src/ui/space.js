/** Computes directions, extents and sections in the space of the surface, for controls and for marks on the picture. */
import { along, cross, distance, dot, vec } from '../engine/vector.js';
import { formatSignificant } from './format.js';

/** @import { Angles, Bounds, Columns, CuttingPlane, Ray, Vec3 } from '../engine/types.js' */

export const AXES = /** @type {const} */ (['x', 'y', 'z']);

/** Returns the unit vector along an axis. @param {number} axis @param {number} [sign] */
export const axisVector = (axis, sign = 1) => vec((k) => (k === axis ? sign : 0));

/** @param {Bounds} bounds */
export const centreOf = ({ min, max }) => vec((k) => (min[k] + max[k]) / 2);

/**
 * Returns a corner of a box; bit k of `index` chooses the larger end along axis k.
 * @param {Bounds} bounds
 * @param {number} index
 */
export const cornerOf = ({ min, max }, index) => vec((k) => ((index >> k) & 1 ? max[k] : min[k]));

/**
 * Returns the direction from the camera's target to its eye.
 * @param {Angles} camera
 * @returns {Vec3}
 */
export const towardEye = ({ yaw, pitch }) => directionOf(yaw, pitch);

/**
 * Returns the unit vector at an azimuth in the xy plane, from x towards y, and an elevation above it.
 * @param {number} azimuth
 * @param {number} elevation
 * @returns {Vec3}
 */
export const directionOf = (azimuth, elevation) => [
  Math.cos(azimuth) * Math.cos(elevation),
  Math.sin(azimuth) * Math.cos(elevation),
  Math.sin(elevation),
];

/**
 * Returns the azimuth and the elevation of a unit vector. The azimuth of a vertical one is 0.
 * @param {readonly number[]} direction
 */
export function anglesOf([x, y, z]) {
  const across = Math.hypot(x, y);
  return { azimuth: across > 1e-9 ? Math.atan2(y, x) : 0, elevation: Math.atan2(z, across) };
}

/** Largest other component of a unit vector that counts as parallel to an axis. Links hold six digits. */
const STRAIGHT = 1e-5;

/**
 * Returns the axis to which a unit vector is parallel, and its sign; null for a free direction.
 * @param {ArrayLike<number>} direction
 */
export function axisOf(direction) {
  for (const axis of [0, 1, 2]) {
    const others = [0, 1, 2].filter((k) => k !== axis);
    if (others.every((k) => Math.abs(direction[k]) < STRAIGHT)) return { axis, sign: Math.sign(direction[axis]) };
  }
  return null;
}

/** The equation of a plane perpendicular to an axis; null for any other. @param {CuttingPlane} plane */
export function equationOf({ normal, offset }) {
  const straight = axisOf(normal);
  return straight && `${AXES[straight.axis]} = ${formatSignificant(straight.sign * offset, 3)}`;
}

/**
 * Returns the smallest and the largest value of direction · p in a box.
 * @param {Bounds} bounds
 * @param {ArrayLike<number>} direction
 * @returns {[number, number]}
 */
export function extentOf({ min, max }, direction) {
  let [low, high] = [0, 0];
  for (const k of [0, 1, 2]) {
    const ends = [direction[k] * min[k], direction[k] * max[k]];
    low += Math.min(...ends);
    high += Math.max(...ends);
  }
  return [low, high];
}

/**
 * Returns the corners of the polygon in which a plane cuts a box, in order around it; empty if it misses the box.
 * @param {Bounds} bounds
 * @param {CuttingPlane} plane
 */
export function sectionOf(bounds, { normal, offset }) {
  /** @type {Vec3[]} */
  const points = [];
  for (let corner = 0; corner < 8; corner += 1) {
    for (const bit of [1, 2, 4]) {
      if (corner & bit) continue;
      const [p, q] = [cornerOf(bounds, corner), cornerOf(bounds, corner | bit)];
      const [a, b] = [dot(normal, p) - offset, dot(normal, q) - offset];
      if (a > 0 === b > 0) continue;
      const t = a / (a - b);
      points.push(along(p, [q[0] - p[0], q[1] - p[1], q[2] - p[2]], t));
    }
  }
  if (points.length < 3) return [];
  const middle = vec((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  const { u, v } = planeOf(normal);
  const angle = (/** @type {Vec3} */ p) => {
    const from = along(p, middle, -1);
    return Math.atan2(dot(from, v), dot(from, u));
  };
  return points.sort((p, q) => angle(p) - angle(q));
}

/**
 * Returns two unit vectors in a plane with this unit normal. The three are right-handed.
 * @param {Vec3} normal
 */
export function planeOf(normal) {
  const u = across(normal);
  return { u, v: cross(normal, u) };
}

/** Returns a unit vector perpendicular to a unit vector. @param {ArrayLike<number>} n @returns {Vec3} */
function across(n) {
  const other = Math.abs(n[0]) < 0.7 ? axisVector(0) : axisVector(1);
  const v = cross(n, other);
  const length = Math.hypot(v[0], v[1], v[2]);
  return [v[0] / length, v[1] / length, v[2] / length];
}

/** Squared sine of the angle between a ray and a line below which the nearest point on the line is ill-defined. */
const END_ON = 0.02;

/**
 * Returns the coordinate along a line of the point nearest to a ray; null if the two are almost parallel.
 * @param {Ray} ray
 * @param {ArrayLike<number>} origin  of the line
 * @param {ArrayLike<number>} axis  its unit direction
 */
export function placeAlong({ eye, direction }, origin, axis) {
  const cosine = dot(direction, axis);
  const sineSq = 1 - cosine * cosine;
  if (sineSq < END_ON) return null;
  const from = along(origin, eye, -1);
  return (cosine * dot(direction, from) - dot(axis, from)) / sineSq;
}

/**
 * Returns the direction from a sphere's centre to the first or, on the far side, last intersection with a ray; for a
 * ray that misses the sphere, to the point nearest to the ray.
 * @param {Ray} ray
 * @param {ArrayLike<number>} centre
 * @param {number} radius
 * @param {boolean} far
 * @returns {Vec3}
 */
export function directionOnSphere({ eye, direction }, centre, radius, far) {
  const to = along(centre, eye, -1);
  const middle = dot(to, direction);
  const halfSq = radius * radius - (dot(to, to) - middle * middle);
  const half = Math.sqrt(Math.max(0, halfSq));
  const from = along(along(eye, direction, middle + (far ? half : -half)), centre, -1);
  const length = Math.hypot(from[0], from[1], from[2]) || 1;
  return [from[0] / length, from[1] / length, from[2] / length];
}

/** Returns a step of 1, 2 or 5 times a power of ten that is at least `least`. @param {number} least */
export function niceStep(least) {
  if (!(least > 0 && least < Infinity)) return 1;
  const power = 10 ** Math.floor(Math.log10(least));
  const factor = [1, 2, 5].find((f) => f * power >= least * (1 - 1e-9)) ?? 10;
  return Number((factor * power).toPrecision(1));
}

/**
 * Returns the multiples of a step within a range, in order.
 * @param {number} low
 * @param {number} high
 * @param {number} step
 */
export function ticksIn(low, high, step) {
  const slack = 1e-9 * step;
  const first = Math.ceil((low - slack) / step);
  const last = Math.floor((high + slack) / step);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/**
 * Returns the straight distance of two particles, in units and over the sum of their radii.
 * @param {Columns} columns
 * @param {readonly number[]} pair
 */
export function separation({ positions, radii, adaptive }, [i, j]) {
  const place = (/** @type {number} */ k) => positions.subarray(3 * k, 3 * k + 3);
  const units = distance(place(i), place(j));
  return { units, diameters: units / (radii[i] + radii[j]), unit: adaptive ? '(r₁ + r₂)' : '2r' };
}
