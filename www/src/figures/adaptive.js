/**
 * The tangent plane of an adaptive particle: its free spaces, how a child is pushed into one, and the angles φ and τ
 * (paper §5, Figs 7 and 8).
 */

import { s } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { childMarks, slotGroup } from './drawings.js';
import { arcOf, polar, unrolled, widthOf } from './geometry.js';
import { label, line, ring } from './svg.js';
import { FATES, inDegrees } from './words.js';

/** @import { Child, Moment, Opened, Plane } from './types.js' */

/** Half size of the drawing, in radii of the particle. */
const HALF = 4.5;
/** Radii of the arcs, over the particle's: the taken angle, and outside it the free one. */
const TAKEN_AT = 1.14;
const FREE_AT = 1.36;
/** Place of the letter τ: this many radians before the end of its arc, at this radius. */
const [TAU_BEFORE, TAU_AT] = [0.06, 1.66];
/** Radius of the dot of a push. */
const DOT = 0.07;

/** @param {Opened} opened @param {Moment} moment */
export function adaptivePlane(opened, moment) {
  const { subject, positions, radii, place } = opened;
  const { frame, gathered, children, slot, isNow, arc, event } = moment;
  const svg = s('svg', {
    class: 'drawing',
    viewBox: `${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`,
    role: 'img',
    'aria-label': words(opened, moment),
  });
  if (frame) {
    const plane = { centre: place, right: frame.u, up: frame.w, radius: subject.radius };
    const at = (/** @type {number} */ particle) => unrolled(plane, positions.subarray(3 * particle, 3 * particle + 3));
    const around = gathered?.neighbours ?? [];
    for (const { particle } of around) svg.append(ring('disc', at(particle), radii[particle] / subject.radius));
    svg.append(ring('self', [0, 0], 1));
    if (arc) svg.append(line('gap', arcOf(arc.angles_rad[0], widthOf(arc.angles_rad), 1)));
    for (const child of children) svg.append(slotGroup(child, discOf(child, plane, child.slot === slot && isNow)));
    for (const { particle } of around) svg.append(label('number', at(particle), formatCount(particle)));
    for (const child of children) svg.append(slotGroup(child, childMarks(child, plane, at)));
    const now = slot === null ? null : children[slot];
    if (now) svg.append(...wayOf(now, plane), ...anglesOf(now, plane));
    if (now?.compared && event.type === 'compared')
      svg.append(ring('tolerance', unrolled(plane, now.compared.position), now.compared.limit / subject.radius));
  }
  if (!frame) svg.append(ring('self', [0, 0], 1));
  svg.append(label('number strong', [0, 0], formatCount(subject.particle)));
  return svg;
}

/** The child as a disc, at its last place. @param {Child} child @param {Plane} plane @param {boolean} isNow */
function discOf({ pushes, fate }, plane, isNow) {
  const last = pushes.at(-1);
  if (!last || (fate !== 'added' && !isNow)) return [];
  return [ring(isNow ? 'slot now' : 'slot', unrolled(plane, last.position), last.radius / plane.radius)];
}

/** The pushes as small steps. @param {Child} child @param {Plane} plane */
function wayOf({ pushes }, plane) {
  const places = pushes.map(({ position }) => unrolled(plane, position));
  return places.length > 0 ? [line('way', places), ...places.map((place) => ring('step', place, DOT))] : [];
}

/**
 * The angle that the child takes, and the free angle, which begin in the same direction.
 * @param {Child} child
 * @param {Plane} plane
 */
function anglesOf({ room, pushes }, plane) {
  const last = pushes.at(-1);
  if (!room || !last) return [];
  const [x, y] = unrolled(plane, last.position);
  const from = Math.atan2(y, x) - room.phi_rad / 2;
  const middle = (/** @type {number} */ width, /** @type {number} */ at) => polar(from + width / 2, at);
  const isRing = room.tau_rad >= 2 * Math.PI;
  return [
    line('free', arcOf(from, room.tau_rad, FREE_AT)),
    line('taken', arcOf(from, room.phi_rad, TAKEN_AT)),
    label('name', middle(room.phi_rad, 0.66), 'φ'),
    // At the end of the free angle, between two discs: its middle may be covered by the number of a disc.
    label('name', isRing ? [0, -FREE_AT - 0.4] : polar(from + room.tau_rad - TAU_BEFORE, TAU_AT), 'τ'),
  ];
}

/** @param {Opened} opened @param {Moment} moment */
function words({ subject }, { frame, gathered, children, slot }) {
  const name = `Tangent plane of particle ${formatCount(subject.particle)}`;
  if (!frame) return `${name}, not laid yet`;
  const around = gathered ? `: ${formatCount(gathered.neighbours.length)} particles around` : '';
  const fates = children
    .filter(({ fate }) => fate !== 'open')
    .map((child) => `slot ${child.slot} ${FATES[child.fate]}`);
  const now = slot === null ? null : children[slot];
  const pushed =
    now && now.pushes.length > 1 ? `; child ${now.slot} pushed ${formatCount(now.pushes.length - 1)} times` : '';
  const room = now?.room
    ? `; it takes φ = ${inDegrees(now.room.phi_rad, 1)} of τ = ${inDegrees(now.room.tau_rad, 1)}`
    : '';
  return `${name}${around}${fates.length > 0 ? `; ${fates.join(', ')}` : ''}${pushed}${room}`;
}
