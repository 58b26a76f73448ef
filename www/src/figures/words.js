/** Describes the events of a particle, and has the paper's Algorithm 2 with the line of each event. */
import { formatCount, formatFixed, formatSignificant, plural } from '../ui/format.js';

/**
 * @import { LessonEvent } from '../engine/types.js'
 * @import { Moment, Subject } from './types.js'
 */

/** A length in radii. @param {number} length @param {number} radius @param {number} [digits] */
export const inRadii = (length, radius, digits = 3) => `${formatFixed(length / radius, digits)}\u00a0r`;

/** @param {number} rad @param {number} [digits] */
export const inDegrees = (rad, digits = 2) => `${formatFixed((rad * 180) / Math.PI, digits)}°`;

/** Subscript digits. @param {number} k */
const subscript = (k) => String(k).replace(/\d/g, (digit) => String.fromCharCode(0x2080 + Number(digit)));

/** Name of the angle of an iterate, such as θ₂. @param {number} k */
export const theta = (k) => `θ${subscript(k)}`;

/** Names of the fates. @type {Record<string, string>} */
export const FATES = {
  open: 'not decided yet',
  parent: 'parent',
  added: 'added',
  matched: 'matched',
  not_converged: 'did not converge',
  outside: 'outside the box',
  undefined: 'undefined',
  capped: 'over the limit',
};

/**
 * Algorithm 2 in words. `of` lists the types of events of a line; a fate is `fate:` with its name.
 * @type {readonly { depth: number, text: string, of: readonly string[] }[]}
 */
export const ALGORITHM = [
  { depth: 0, text: 'While particles wait: take the next one, p', of: ['taken'] },
  { depth: 1, text: 'Lay the tangent frame of p, slot 0 towards its parent', of: ['frame'] },
  { depth: 1, text: 'For each free slot: start a child at 2r from p', of: ['slot'] },
  { depth: 2, text: 'turn it along its circle until f = 0', of: ['iterate', 'landed'] },
  { depth: 1, text: 'Gather the particles around p', of: ['gathered'] },
  { depth: 1, text: 'Slot 0 holds the parent, if p has one', of: ['fate:parent'] },
  { depth: 1, text: 'For each child: find the nearest of those particles', of: ['compared', 'fronts_meet'] },
  { depth: 2, text: 'if it is within the tolerance, that particle is the child', of: ['fate:matched'] },
  {
    depth: 2,
    text: 'if it is not on the surface in the box, leave it out',
    of: ['fate:not_converged', 'fate:outside', 'fate:undefined', 'fate:capped'],
  },
  { depth: 2, text: 'otherwise add it, and let it wait its turn', of: ['added', 'fate:added'] },
  { depth: 1, text: 'Mark p as done', of: ['done'] },
];

/**
 * Algorithm 2 for particles of varying sizes (§5): children are pushed into the free spaces around them.
 * @type {typeof ALGORITHM}
 */
export const ADAPTIVE = [
  { depth: 0, text: 'While particles wait: take the next one, p', of: ['taken'] },
  { depth: 1, text: 'Gather the particles around p', of: ['gathered'] },
  { depth: 1, text: 'Lay the tangent frame of p', of: ['frame', 'fate:parent'] },
  { depth: 1, text: 'For each free space between two that touch p:', of: ['arc'] },
  { depth: 2, text: 'start a child on the circle of p, beside the last one', of: ['start'] },
  { depth: 2, text: 'push it away from p, until the two do not overlap', of: ['push'] },
  { depth: 2, text: 'push it along the circle, until it overlaps the others least', of: ['push_on_circle'] },
  { depth: 2, text: 'compare the angle φ that it takes with the free one, τ', of: ['room'] },
  { depth: 2, text: 'if there is room, bring it onto the surface', of: ['slot', 'iterate', 'landed', 'compared'] },
  { depth: 2, text: 'add it, and go on behind it', of: ['added', 'fate:added'] },
  {
    depth: 2,
    text: 'otherwise the space is done',
    of: ['fate:matched', 'fate:not_converged', 'fate:outside', 'fate:undefined', 'fate:capped'],
  },
  { depth: 1, text: 'Mark p as done', of: ['done'] },
];

/**
 * Index of an event's line in an algorithm; −1 for none.
 * @param {LessonEvent} event
 * @param {typeof ALGORITHM} [lines]
 */
export function lineOf(event, lines = ALGORITHM) {
  const name = event.type === 'fate' ? `fate:${event.fate}` : event.type;
  return lines.findIndex(({ of }) => of.includes(name));
}

/**
 * Describes an event in one or two sentences.
 * @param {Moment} moment @param {Subject} subject
 */
export function tell({ event, slot, children, evaluations }, subject) {
  const { radius, nameOf = formatCount } = subject;
  const particleOf = (/** @type {number} */ particle) => `particle ${nameOf(particle)}`;
  switch (event.type) {
    case 'taken':
      return `Particle ${nameOf(event.particle)} is taken from the queue. Its children are to be placed.`;
    case 'frame':
      return subject.parent === null
        ? 'Its tangent plane is laid. A seed has no parent, so slot 0 points anywhere; the others follow every 60°.'
        : `Its tangent plane is laid. Slot 0 points to its parent, ${particleOf(subject.parent)}; the others follow every 60°.`;
    case 'slot':
      return `The child of slot ${event.slot} starts on the circle of radius 2r around the particle, at ${theta(0)} = ${inDegrees(event.theta_rad)}.`;
    case 'iterate':
      return tellIterate(event);
    case 'landed':
      return `The child of slot ${event.slot} lands on the surface, ${inRadii(event.distance, radius)} from its parent.`;
    case 'gathered': {
      const { length } = event.neighbours;
      const near = `${plural(length, 'particle')} within ${inRadii(event.reach, radius, 0)}`;
      return `${near}: the children are compared with ${length === 1 ? 'it' : 'them'}.`;
    }
    case 'compared':
      return tellComparison(event, radius, particleOf);
    case 'fronts_meet':
      return event.is_other
        ? `The front of another seed is met at ${particleOf(event.particle)}.`
        : `The front meets itself at ${particleOf(event.particle)}, out of step.`;
    case 'added':
      return `A new one, ${particleOf(event.particle)}, is added where the child of slot ${slot} landed. It waits its turn.`;
    case 'fate':
      return tellFate(event, particleOf);
    case 'arc':
    case 'start':
    case 'push':
    case 'push_on_circle':
    case 'room':
      return tellPush(event, radius, particleOf);
    case 'done': {
      const placed = children.filter(({ fate }) => fate === 'added').length;
      const met = children.filter(({ fate }) => fate === 'matched').length;
      const cost = plural(evaluations, 'evaluation');
      return `The particle is done: ${placed} of its children added, ${met} matched, after ${cost} of f.`;
    }
    default:
      return '';
  }
}

/** @param {Extract<LessonEvent, {type: 'iterate'}>} event */
function tellIterate({ slot, step, theta_rad: angle, value }) {
  const where = angle === null ? `step ${step}` : `${theta(step)} = ${inDegrees(angle)}`;
  return `The child of slot ${slot} at ${where}: f = ${formatSignificant(value, 3)}.`;
}

/** @typedef {(particle: number) => string} Name  of a particle */

/** @param {Extract<LessonEvent, {type: 'compared'}>} event @param {number} radius @param {Name} particleOf */
function tellComparison({ slot, against, distance, limit, corresponds }, radius, particleOf) {
  if (against === null || distance === null) return `The child of slot ${slot} has no particle of its sheet near it.`;
  const far = `The child of slot ${slot} is ${inRadii(distance, radius)} from ${particleOf(against)}, its nearest.`;
  const bound = inRadii(limit, radius, 2);
  return corresponds
    ? `${far} That is within the tolerance of ${bound}.`
    : `${far} That is more than the tolerance of ${bound}: the place is free.`;
}

/**
 * @param {Extract<LessonEvent, {type: 'arc' | 'start' | 'push' | 'push_on_circle' | 'room'}>} event
 * @param {number} radius @param {Name} particleOf
 */
function tellPush(event, radius, particleOf) {
  switch (event.type) {
    case 'arc': {
      const { before, behind, angles_rad: angles } = event;
      if (before === null || behind === null)
        return 'Nothing touches the particle yet: the whole circle around it is free.';
      const width = (angles[1] - angles[0] + 2 * Math.PI) % (2 * Math.PI) || 2 * Math.PI;
      return before === behind
        ? `Only ${particleOf(before)} touches it: the space behind that one goes once around.`
        : `The space between ${particleOf(before)} and ${particleOf(behind)} is next: ${inDegrees(width, 1)} of the circle.`;
    }
    case 'start':
      return event.tangent === null
        ? `The child of slot ${event.slot} starts on the circle of its parent. There its radius would be ${inRadii(event.radius, radius)}.`
        : `The child of slot ${event.slot} starts on the circle of its parent, beside the last child. There its radius would be ${inRadii(event.radius, radius)}.`;
    case 'push':
      return `The child of slot ${event.slot} is pushed away from its parent, to where its radius is ${inRadii(event.radius, radius)}.`;
    case 'push_on_circle':
      return event.overlap > 0
        ? `The child of slot ${event.slot} is pushed along the circle. It still overlaps another by ${formatFixed(100 * event.overlap, 1)} %.`
        : `The child of slot ${event.slot} is pushed along the circle. It overlaps none any more.`;
    case 'room': {
      const angles = `The child of slot ${event.slot} takes φ = ${inDegrees(event.phi_rad, 1)}; τ = ${inDegrees(event.tau_rad, 1)} are free, ${formatFixed((100 * event.tau_rad) / event.phi_rad, 0)} % of that.`;
      return event.fits ? `${angles} There is room.` : `${angles} There is no room: this space is done.`;
    }
  }
}

/** @param {Extract<LessonEvent, {type: 'fate'}>} event @param {Name} particleOf */
function tellFate({ slot, fate, particle }, particleOf) {
  const other = particle === null ? '' : particleOf(particle);
  switch (fate) {
    case 'parent':
      return `Slot 0 holds the parent, ${other}.`;
    case 'added':
      return `The child of slot ${slot} became ${other}.`;
    case 'matched':
      return particle === null
        ? `The child of slot ${slot} has no room and is not added.`
        : `The child of slot ${slot} matched ${other}, so nothing is added.`;
    case 'outside':
      return `The child of slot ${slot} lies outside the box and is left out.`;
    case 'not_converged':
      return `The child of slot ${slot} found no point of the surface on its circle and is left out.`;
    case 'undefined':
      return `f is undefined where the child of slot ${slot} was looked for. It is left out.`;
    case 'capped':
      return `The child of slot ${slot} is left out: the run has reached its limit on particles.`;
    default:
      return '';
  }
}
