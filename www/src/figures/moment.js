/**
 * The state of a particle at one of its events. It is computed from the events up to that one, so a step back gives
 * exactly the earlier state.
 */

/**
 * @import { LessonEvent } from '../engine/types.js'
 * @import { Child, Moment, Of } from './types.js'
 */

const SLOTS = 6;

/** Number of slots that occur in events. @param {readonly LessonEvent[]} events */
const slotsOf = (events) => events.reduce((most, event) => Math.max(most, (slotOf(event) ?? 0) + 1), 1);

/** Whether a particle is treated by §5 of the paper. @param {readonly LessonEvent[]} events */
export const isAdaptive = (events) => events.some(({ type }) => type === 'arc');

/**
 * @param {readonly LessonEvent[]} events  of one particle, from `taken` to `done`
 * @param {number} at
 */
export function momentAt(events, at) {
  /** @type {Moment} */
  const moment = {
    event: events[at],
    frame: null,
    gathered: null,
    arc: null,
    children: Array.from({ length: isAdaptive(events) ? slotsOf(events) : SLOTS }, (_, slot) => ({
      slot,
      start: null,
      iterates: [],
      landed: null,
      compared: null,
      pushes: [],
      room: null,
      fate: 'open',
      particle: null,
    })),
    slot: null,
    isNow: slotOf(events[at]) !== null || events[at].type === 'added',
    evaluations: 0,
  };
  for (const event of events.slice(0, at + 1)) include(moment, event);
  return moment;
}

/** @param {Moment} moment @param {LessonEvent} event */
function include(moment, event) {
  const slot = slotOf(event);
  if (slot !== null) moment.slot = slot;
  switch (event.type) {
    case 'frame':
      moment.frame = event;
      break;
    case 'gathered':
      moment.gathered = event;
      break;
    case 'slot':
      moment.children[event.slot].start = event;
      break;
    case 'arc':
      moment.arc = event;
      moment.slot = null;
      break;
    case 'start':
    case 'push':
    case 'push_on_circle':
      moment.children[event.slot].pushes.push(event);
      break;
    case 'room':
      moment.children[event.slot].room = event;
      break;
    case 'iterate':
      begin(moment.children[event.slot], event);
      moment.children[event.slot].iterates.push(event);
      moment.evaluations += 1;
      break;
    case 'landed':
      moment.children[event.slot].landed = event;
      break;
    case 'compared':
      moment.children[event.slot].compared = event;
      break;
    case 'added':
      // The child that was compared last.
      if (moment.slot !== null) moment.children[moment.slot].particle = event.particle;
      break;
    case 'fate': {
      const child = moment.children[event.slot];
      child.fate = event.fate;
      child.particle = event.particle;
      break;
    }
    default:
  }
}

/**
 * Starts the search for an adaptive child where it was pushed to: on the circle of that radius around its parent.
 * @param {Child} child @param {Of<'iterate'>} iterate  the first one
 */
function begin(child, { parent, slot, position }) {
  if (child.start || child.pushes.length === 0) return;
  child.start = { type: 'slot', parent, slot, direction: [0, 0, 0], theta_rad: 0, place: position };
}

/** The slot of an event; null if it has none. @param {LessonEvent} event */
function slotOf(event) {
  return 'slot' in event ? event.slot : null;
}
