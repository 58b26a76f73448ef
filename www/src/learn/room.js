/**
 * A particle in a plane among particles of another size: the events in which its children find room, following §5 of
 * the paper and `src/paper/adaptive.rs`.
 */
import { distance } from '../engine/vector.js';
import { polar } from '../figures/geometry.js';

/** @import { LessonEvent, Vec3 } from '../engine/types.js' */
/** @import { Point } from '../figures/types.js' */

/** A child stays if this share of its angle is free, as in the lesson's runs. */
export const FIT = 0.5;
/** The particle itself, and the one that initially touches it. */
const [PARENT, FIRST] = [0, 1];
const MOST_CHILDREN = 12;

/**
 * The angle φ that a disc of radius b occupies around a disc of radius a that it touches.
 * @param {number} a @param {number} b
 */
export const takenAngle = (a, b) => 2 * Math.asin(b / (a + b));

/** @param {Point} at @returns {Vec3} */
const inSpace = ([x, y]) => [x, y, 0];

/**
 * The events around a particle of radius a, surrounded by particles of radius b.
 * @param {number} a @param {number} b @returns {LessonEvent[]}
 */
export function roomEvents(a, b) {
  const phi = takenAngle(a, b);
  const parent = PARENT;
  const first = polar(0, a + b);
  /** @type {LessonEvent[]} */
  const events = [
    { type: 'frame', particle: PARENT, normal: [0, 0, 1], u: [1, 0, 0], w: [0, 1, 0] },
    { type: 'gathered', particle: PARENT, reach: 3 * a, neighbours: [{ particle: FIRST, distance: a + b }] },
    { type: 'arc', parent, before: FIRST, behind: FIRST, angles_rad: [0, 2 * Math.PI] },
  ];
  let angle = 0;
  for (let slot = 0; slot < MOST_CHILDREN; slot += 1) {
    const last = polar(angle, a + b);
    // I lies on the circle of the last one, at right angles to its direction.
    const tangent = /** @type {Point} */ ([last[0] - b * Math.sin(angle), last[1] + b * Math.cos(angle)]);
    const way = Math.atan2(tangent[1], tangent[0]);
    const of = { parent, slot, radius: b };
    const start = inSpace(polar(way, a));
    const pushed = inSpace(polar(way, a + b));
    events.push({ type: 'start', ...of, tangent: inSpace(tangent), position: start });
    events.push({ type: 'push', ...of, position: pushed });
    const tau = 2 * Math.PI - angle - phi;
    // Along the circle until it touches the last one, or halfway to the first if it overlaps both.
    angle += tau < phi ? (tau + phi) / 2 : phi;
    const position = inSpace(polar(angle, a + b));
    const overlap = tau < phi ? 1 - distance(position, inSpace(first)) / (2 * b) : 0;
    events.push({ type: 'push_on_circle', ...of, position, overlap: Math.max(0, overlap) });
    // The tolerance keeps rounding from deciding.
    const fits = tau >= FIT * phi - 1e-9;
    events.push({ type: 'room', parent, slot, phi_rad: phi, tau_rad: Math.max(0, tau), fits });
    const fate = fits ? 'added' : 'matched';
    events.push({ type: 'fate', parent, slot, fate, particle: fits ? FIRST + 1 + slot : null });
    if (!fits) break;
  }
  return events;
}
