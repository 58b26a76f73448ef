/** The two drawings of a particle: its tangent plane from above, and the plane of a slot from the side. */

import { dot } from '../engine/vector.js';
import { s } from '../ui/dom.js';
import { formatCount, formatFixed } from '../ui/format.js';
import { inPlane, scaledBy, slotPlace } from './geometry.js';
import { fateShape, label, line, ring, segments } from './svg.js';
import { FATES, inRadii, theta } from './words.js';

/** @import { Child, Moment, Opened, Plane, Point, Profile } from './types.js' */

/** Half sizes of the drawings, in radii. */
const TANGENT_HALF = 5.05;
const PROFILE = { left: -2.4, right: 2.9, half: 2.3 };
/** Half size of a fate's shape, and distance of a slot's number from the particle: between its disc and the child. */
const SHAPE = 0.27;
const NUMBER_AT = 1.38;
/** Distance of a particle's number from the particle's centre, and least distance from the shape of a fate. */
const [BESIDE, CLEAR] = [0.58, 0.5];
/** Radius around the central particle that numbers keep clear of: a little less than that of its disc. */
const MIDDLE = 0.85;

/**
 * Draws the tangent plane: the six slots, the particles around, and what became of the children.
 * @param {Opened} opened @param {Moment} moment
 */
export function tangentPlane(opened, moment) {
  const { subject, positions, normals, place } = opened;
  const { frame, gathered, children, slot, isNow } = moment;
  const { nameOf = formatCount } = subject;
  const svg = s('svg', {
    class: 'drawing',
    viewBox: `${-TANGENT_HALF} ${-TANGENT_HALF} ${2 * TANGENT_HALF} ${2 * TANGENT_HALF}`,
    role: 'img',
    'aria-label': tangentWords(opened, moment),
  });
  if (frame) {
    const plane = { centre: place, right: frame.u, up: frame.w, radius: subject.radius };
    const at = (/** @type {number} */ particle) => inPlane(plane, positions.subarray(3 * particle, 3 * particle + 3));
    for (const { particle } of gathered?.neighbours ?? []) {
      const other = dot(frame.normal, normals.subarray(3 * particle, 3 * particle + 3)) <= 0;
      svg.append(ring(other ? 'disc other' : 'disc', at(particle), 1));
    }
    const added = children.flatMap((child) => {
      const place = child.fate === 'added' ? placeOf(child, plane, at) : null;
      return place ? [{ place, particle: child.particle }] : [];
    });
    for (const { place } of added) svg.append(ring('disc', place, 1));
    svg.append(ring('circle', [0, 0], 2));
    for (const child of children) svg.append(slotGroup(child, slotMarks(child, child.slot === slot && isNow)));
    for (const child of children) svg.append(slotGroup(child, childMarks(child, plane, at)));
    const shapes = children.map((child) => placeOf(child, plane, at)).filter((shape) => shape !== null);
    const taken = [...shapes, ...children.map(numberPlace)];
    for (const { particle } of gathered?.neighbours ?? []) {
      svg.append(ring('centre', at(particle), 0.08));
      svg.append(label('number', clear(at(particle), taken, nameOf(particle)), nameOf(particle)));
    }
    for (const { place, particle } of added)
      if (particle !== null) svg.append(label('number', clear(place, taken, nameOf(particle)), nameOf(particle)));
    const now = slot === null ? null : children[slot];
    if (now?.compared && moment.event.type === 'compared')
      svg.append(ring('tolerance', inPlane(plane, now.compared.position), now.compared.limit / subject.radius));
  }
  svg.append(ring('self', [0, 0], 1), label('number strong', [0, 0], nameOf(subject.particle)));
  return svg;
}

/** Groups the marks of a slot under its number. @param {Child} child @param {Element[]} marks */
export const slotGroup = ({ slot }, marks) => s('g', { 'data-slot': slot }, ...marks);

/** Directions from a particle's centre in which its number is tried, after those away from the middle. */
const AROUND = Array.from({ length: 8 }, (_, k) => (k * Math.PI) / 4);

/**
 * Returns the place of a particle's number within its disc: outwards, or elsewhere if it would be covered.
 * @param {Point} at @param {readonly Point[]} taken  places of the shapes and of the slots' numbers
 * @param {string} name  the number; three digits are wider than high
 * @returns {Point}
 */
function clear([x, y], taken, name) {
  const wide = Math.max(1, name.length / 2);
  const outwards = y > 0.5 ? Math.PI / 2 : -Math.PI / 2;
  const places = AROUND.map((turn) => {
    const way = outwards + turn;
    return /** @type {Point} */ ([x + BESIDE * Math.cos(way), y + BESIDE * Math.sin(way)]);
  });
  // The particle in the middle lies over its neighbours.
  const room = places.map(([u, v]) =>
    Math.min(Math.hypot(u, v) - MIDDLE, ...taken.map((one) => Math.hypot((one[0] - u) / wide, one[1] - v))),
  );
  const free = room.findIndex((far) => far >= CLEAR);
  return places[free < 0 ? room.indexOf(Math.max(...room)) : free];
}

/** The place of a slot's number. @param {Pick<Child, 'slot'>} child */
const numberPlace = ({ slot }) => scaledBy(slotPlace(slot), NUMBER_AT / 2);

/** @param {Child} child @param {boolean} isNow */
function slotMarks({ slot }, isNow) {
  const end = slotPlace(slot);
  const between = numberPlace({ slot });
  return [
    line(isNow ? 'ray now' : 'ray', [[0, 0], end]),
    ring(isNow ? 'slot now' : 'slot', end, 1),
    label(isNow ? 'slot-number now' : 'slot-number', between, String(slot)),
  ];
}

/**
 * Returns the place of a child; null before it is tried.
 * @param {Child} child @param {Plane} plane @param {(particle: number) => Point} at
 */
function placeOf({ fate, landed, start, particle, iterates }, plane, at) {
  if (fate === 'parent') return particle === null ? null : at(particle);
  const where = landed?.position ?? iterates.at(-1)?.position ?? start?.place;
  return where ? inPlane(plane, where) : null;
}

/**
 * Draws a child with the shape of its fate, and a line to the particle that it matched.
 * @param {Child} child @param {Plane} plane @param {(particle: number) => Point} at
 */
export function childMarks(child, plane, at) {
  const { fate, particle } = child;
  const here = placeOf(child, plane, at);
  if (!here) return [];
  return [
    fate === 'matched' && particle !== null ? line('met', [here, at(particle)]) : null,
    fateShape(fate, here, SHAPE),
  ].filter((mark) => mark !== null);
}

/** @param {Opened} opened @param {Moment} moment */
function tangentWords({ subject }, { frame, gathered, children }) {
  const { nameOf = formatCount } = subject;
  const plane = `Tangent plane of particle ${nameOf(subject.particle)}`;
  if (!frame) return `${plane}, not laid yet`;
  const fates = children.filter(({ fate }) => fate !== 'open').map(({ slot, fate }) => `slot ${slot} ${FATES[fate]}`);
  const around = gathered ? `, ${formatCount(gathered.neighbours.length)} particles around` : '';
  return `${plane}: six slots${around}${fates.length > 0 ? `; ${fates.join(', ')}` : ''}`;
}

/**
 * Draws the plane of a slot from the side: the surface, the circle, the search on it, and Newton's steps to compare.
 * @param {Opened} opened @param {Profile} profile  of the slot @param {Child} child
 */
export function profileOf(opened, profile, child) {
  const { subject, place } = opened;
  const { radius } = subject;
  const { left, right, half } = PROFILE;
  const svg = s('svg', {
    class: 'drawing profile',
    viewBox: `${left} ${-half} ${right - left} ${2 * half}`,
    role: 'img',
    'aria-label': profileWords(opened, profile, child),
  });
  const plane = { centre: place, right: profile.direction, up: profile.normal, radius };
  svg.append(
    line('plane', [
      [left, 0],
      [right, 0],
    ]),
    line('normal', [
      [0, 0],
      [0, 1],
    ]),
    label('name', [0.28, 0.9], 'N'),
    label('name', [2.72, -0.34], 'V'),
    ring('circle', [0, 0], profile.reach / radius),
    segments('curve', profile.section, 1 / radius),
  );
  svg.append(...searchMarks(child, profile, (where) => inPlane(plane, where), { size: 0.14, distance: true }));
  svg.append(ring('point', [0, 0], 0.1), label('name', [-0.3, -0.42], 'p'));
  return svg;
}

/** Whether the search for a child is over, so that Newton's result may be compared with it. @param {Child} child */
export const isSearched = ({ landed, fate }) => landed !== null || fate !== 'open';

/**
 * Draws the places that were tried, where the child landed, and the way of Newton's method from the same start.
 * @param {Child} child @param {Profile} profile
 * @param {(place: ArrayLike<number>) => Point} at
 * @param {{ size: number, distance: boolean }} how  `distance`: with the line from the particle, and one name instead
 *   of all
 */
function searchMarks(child, profile, at, { size, distance }) {
  const { start, iterates, landed } = child;
  if (!start) return [];
  /** @type {Element[]} */
  const marks = [];
  const tried = [start.place, ...iterates.slice(1).map(({ position }) => position)].map(at);
  if (distance && landed) marks.push(line('distance', [[0, 0], at(landed.position)]));
  marks.push(...tried.map((place) => ring('theta', place, 0.7 * size)));
  if (landed) marks.push(ring('landed', at(landed.position), size));
  if (isSearched(child) && profile.newton.length > 0) {
    const way = [start.place, ...profile.newton.map(({ position }) => position)].map(at);
    const [x, y] = way[way.length - 1];
    const end = [-1, 1].map((side) =>
      line('newton-end', [
        [x - size, y - side * size],
        [x + size, y + side * size],
      ]),
    );
    marks.push(line('newton-way', way), ...end);
  }
  const named = distance ? tried.slice(0, 1) : tried;
  marks.push(...named.map(([x, y], k) => label('name', [x + 2.4 * size, y + 1.6 * size], theta(k))));
  return marks;
}

/** Half length of the circle's arc in a lens, in half sizes of the lens, and the number of its segments. */
const ARC = 1.6;
const ARC_PARTS = 24;

/**
 * Enlarges the surroundings of the landing, because steps are short on a smooth surface; null if all points coincide.
 * @param {Opened} opened @param {Profile} profile @param {Child} child
 */
export function lens({ subject, place }, profile, child) {
  const about = profile.lens;
  if (!about || !child.start) return null;
  const { centre, half, section } = about;
  const plane = { centre: place, right: profile.direction, up: profile.normal, radius: subject.radius };
  /** @param {Point} point in radii @returns {Point} */
  const enlarged = ([x, y]) => [(x - centre[0]) / half, (y - centre[1]) / half];
  const middle = Math.atan2(centre[1], centre[0]);
  const reach = profile.reach / subject.radius;
  const arc = Array.from({ length: ARC_PARTS + 1 }, (_, k) => {
    const angle = middle + (k / ARC_PARTS - 0.5) * ARC * half;
    return enlarged([reach * Math.cos(angle), reach * Math.sin(angle)]);
  });
  return s(
    'svg',
    { class: 'drawing lens', viewBox: '-1 -1 2 2', 'aria-hidden': 'true' },
    line('circle', arc),
    line('plane', [enlarged([centre[0] - half, 0]), enlarged([centre[0] + half, 0])]),
    segments('curve', section, 1 / (subject.radius * half)),
    ...searchMarks(child, profile, (where) => enlarged(inPlane(plane, where)), { size: 0.09, distance: false }),
  );
}

/** A landing this many radii from the plane is reported: its cross is then visibly off the curve. */
export const ASIDE = 0.02;

/**
 * Says that Newton's method has left the plane of a drawing, if it has.
 * @param {Pick<Profile, 'newtonAside'>} profile
 */
export const asideWords = ({ newtonAside }) =>
  newtonAside > ASIDE ? `, ${formatFixed(newtonAside, 2)} r in front of this drawing or behind it` : '';

/** @param {Opened} opened @param {Profile} profile @param {Child} child */
function profileWords({ subject }, profile, child) {
  const words = [`The plane of slot ${child.slot} from the side: the surface and the circle of radius 2r`];
  if (child.iterates.length > 0) words.push(`${formatCount(child.iterates.length)} places tried on the circle`);
  if (child.landed) words.push(`the child lands ${inRadii(child.landed.distance, subject.radius)} from the particle`);
  if (isSearched(child) && profile.newtonDistance !== null)
    words.push(
      `Newton’s method would land ${inRadii(profile.newtonDistance, subject.radius)} away${asideWords(profile)}`,
    );
  return words.join('; ');
}
