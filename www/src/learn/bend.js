/**
 * A slot from the side: f on the circle of a child, and how near to the parent Newton's method lands where the surface
 * bends. Lengths are those of the surface's box; a place in the plane of the slot is (along V, along N).
 */
import { along, cross, dot, size, triple } from '../engine/vector.js';
import { inPlane } from '../figures/geometry.js';
import { RESIDUAL } from '../figures/particle.js';
import { NoSurface } from './lab.js';

/**
 * @import { LessonEvent, Vec3 } from '../engine/types.js'
 * @import { Point } from '../figures/types.js'
 * @import { Landing, SlotCase } from './types.js'
 */

/** The circle is searched up to this angle, and turned by at most this one in a step, as in the core. */
export const MOST_THETA = (Math.PI * 5) / 9;
const MOST_TURN = 2 * Math.atan(0.2);
/** The step of a difference quotient, and of the samples of f on the circle of a particle. */
const STEP = Math.PI / 90;
/** A child this near to the surface, in r, has landed: the hand cannot turn more finely. */
const NEAR = 0.01;
const MOST_NEWTON = 30;
/** Half size of the curve that is drawn, in radii, and its parts. */
const HALF = 3.2;
const PARTS = 96;

/** Places on the circle of a child. @param {number} reach @param {number} theta @returns {Point} */
export const onCircle = (reach, theta) => [reach * Math.cos(theta), reach * Math.sin(theta)];

/** Whether a child that is turned to an angle lies on the surface. @param {SlotCase} slot @param {number} theta */
export const isOn = ({ valueAt, slope, radius }, theta) => Math.abs(valueAt(theta)) <= NEAR * radius * slope;

/**
 * The narrowest pair of angles that were tried between which f changes its sign; null if there is none.
 * @param {SlotCase} slot @param {readonly number[]} tried  @returns {[number, number] | null}
 */
export function bracketOf({ valueAt }, tried) {
  const known = tried.filter((theta) => Number.isFinite(valueAt(theta))).sort((one, other) => one - other);
  /** @type {[number, number][]} */
  const pairs = known.slice(1).map((theta, k) => [known[k], theta]);
  const changing = pairs.filter(([from, to]) => valueAt(from) < 0 !== valueAt(to) < 0);
  return changing.sort((one, other) => one[1] - one[0] - (other[1] - other[0]))[0] ?? null;
}

/**
 * The angle after one step of the search on the circle: Newton's method in θ, by no more than 23°, or where that leaves
 * the bracket, the middle of it.
 * @param {SlotCase} slot @param {number} theta @param {readonly [number, number] | null} [bracket]
 */
export function turned({ valueAt }, theta, bracket = null) {
  const half = STEP / 2;
  const rise = (valueAt(theta + half) - valueAt(theta - half)) / STEP;
  const turn = -valueAt(theta) / rise;
  const next = theta + turn;
  if (bracket && !(next >= bracket[0] && next <= bracket[1])) return (bracket[0] + bracket[1]) / 2;
  if (!Number.isFinite(turn)) return theta;
  return Math.max(-MOST_THETA, Math.min(MOST_THETA, theta + Math.max(-MOST_TURN, Math.min(MOST_TURN, turn))));
}

/**
 * How far from its parent Newton's method lands on a surface of constant bend, over 2r. It follows a gradient that
 * points to one centre: a sphere's.
 * @param {number} bend  times r
 */
export function newtonShare(bend) {
  if (bend === 0) return 1;
  return Math.sqrt(2 * (1 - 1 / Math.sqrt(1 + 4 * bend * bend))) / (2 * Math.abs(bend));
}

/**
 * A slot on a surface of constant bend: a sphere through p, whose f has the slope 1 there.
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
  return {
    bend,
    radius,
    slope: 1,
    valueAt: (theta) => value(onCircle(reach, theta)),
    newton: newton.slice(1),
    landing: Math.hypot(landing[0], landing[1]),
    aside: 0,
    section: sectionOn(bend, HALF * radius),
  };
}

/** The curve of constant bend as segments, out to a distance from p. @param {number} bend @param {number} half */
function sectionOn(bend, half) {
  // Every point at the angle t around the centre; without a bend, a line.
  const most = bend * half < 1 ? half * 1.5 : Math.PI / bend;
  const at = (/** @type {number} */ s) =>
    bend > 0 ? [Math.sin(s * bend) / bend, (Math.cos(s * bend) - 1) / bend] : [s, 0];
  return Float32Array.from({ length: 4 * PARTS }, (_, k) => {
    const part = Math.floor(k / 4) + (k % 4 > 1 ? 1 : 0);
    return at(most * ((2 * part) / PARTS - 1))[k % 2];
  });
}

/**
 * The slot of a run: f is sampled on the circle, and joined by straight lines.
 * @param {Awaited<ReturnType<typeof import('./measure.js').openBend>>} at  @returns {Promise<SlotCase>}
 */
export async function slotOf({ run, opened, whole, slot, profile }) {
  if (!profile) throw new NoSurface('Here the slot holds the parent.');
  const { place, subject } = opened;
  const { normal, direction, reach } = profile;
  const count = Math.round((2 * MOST_THETA) / STEP) + 2;
  const samples = await Promise.all(
    Array.from({ length: count + 1 }, async (_, k) => {
      const [x, y] = onCircle(reach, (k - count / 2) * STEP);
      const start = along(along(place, direction, x), normal, y);
      const [first] = await run.client.ask('newton', { start, reach });
      return first ?? { value: Number.NaN, slope: Number.NaN };
    }),
  );
  const plane = { centre: place, right: direction, up: normal, radius: 1 };
  const flat = (/** @type {ArrayLike<number>} */ where) => inPlane(plane, where);
  const landed = whole.children[slot].landed;
  const [x, y] = landed ? flat(landed.position) : [reach, 0];
  return {
    bend: chordBend(x, y),
    radius: subject.radius,
    slope: samples[Math.round(count / 2)].slope,
    valueAt(theta) {
      const at = theta / STEP + count / 2;
      const k = Math.max(0, Math.min(count - 1, Math.floor(at)));
      return samples[k].value + (at - k) * (samples[k + 1].value - samples[k].value);
    },
    newton: profile.newton.map(({ position }) => flat(position)),
    landing: profile.newtonDistance,
    aside: profile.newtonAside * subject.radius,
    section: profile.section,
  };
}

/**
 * The bend of the circle that touches the tangent plane in p and goes through a place.
 * @param {number} x @param {number} y
 */
const chordBend = (x, y) => (-2 * y) / (x * x + y * y);

/**
 * Where Newton's method placed the particles of a run with it: the bend there times r, and the distance from the parent
 * over 2r.
 * @param {readonly LessonEvent[]} events @param {Float32Array} positions  of all particles @param {number} radius
 */
export function landingsOf(events, positions, radius) {
  /** @type {Landing[]} */
  const landings = [];
  /** @type {Vec3} */
  let normal = [0, 0, 1];
  /** By slot, of the particle that is treated. @type {{ direction: Vec3, landing: Landing | null }[]} */
  let slots = [];
  for (const event of events) {
    if (event.type === 'frame') [normal, slots] = [event.normal, []];
    else if (event.type === 'slot') slots[event.slot] = { direction: event.direction, landing: null };
    else if (event.type === 'landed') {
      const way = along(event.position, triple(positions, event.parent), -1);
      const [high, far] = [dot(way, normal), size(way)];
      slots[event.slot].landing = {
        parent: event.parent,
        slot: event.slot,
        bend: Math.abs((2 * high * radius) / (far * far)),
        share: far / (2 * radius),
        aside: Math.abs(dot(way, cross(slots[event.slot].direction, normal))) / radius,
      };
    } else if (event.type === 'fate' && event.fate === 'added') {
      const { landing } = slots[event.slot];
      if (landing) landings.push(landing);
    }
  }
  return landings;
}
