import { describe, expect, test } from 'vitest';
import { arcOf, inPlane, lensOf, slotPlace, unrolled, widthOf } from '../../../src/figures/geometry.js';
import { isAdaptive, momentAt } from '../../../src/figures/moment.js';
import { ADAPTIVE, ALGORITHM, lineOf, tell } from '../../../src/figures/words.js';

/**
 * @import { LessonEvent } from '../../../src/engine/types.js'
 */

/** The events of a particle with two children: one is added, one matches. @type {LessonEvent[]} */
const events = [
  { type: 'taken', particle: 47 },
  { type: 'frame', particle: 47, normal: [0, 0, 1], u: [1, 0, 0], w: [0, 1, 0] },
  { type: 'slot', parent: 47, slot: 1, direction: [0.5, 0.866, 0], theta_rad: 0, place: [0.1, 0.1732, 0] },
  {
    type: 'iterate',
    parent: 47,
    slot: 1,
    step: 0,
    theta_rad: 0,
    position: [0.1, 0.1732, 0],
    value: 0.002,
    slope: 4,
  },
  {
    type: 'iterate',
    parent: 47,
    slot: 1,
    step: 1,
    theta_rad: -0.0125,
    position: [0.1, 0.1732, -0.0025],
    value: 1e-7,
    slope: 4,
  },
  { type: 'landed', parent: 47, slot: 1, position: [0.1, 0.1732, -0.0025], normal: [0, 0, 1], distance: 0.2 },
  { type: 'slot', parent: 47, slot: 2, direction: [-0.5, 0.866, 0], theta_rad: 0, place: [-0.1, 0.1732, 0] },
  { type: 'landed', parent: 47, slot: 2, position: [-0.1, 0.1732, 0], normal: [0, 0, 1], distance: 0.2 },
  { type: 'gathered', particle: 47, reach: 0.4, neighbours: [{ particle: 31, distance: 0.21 }] },
  { type: 'fate', parent: 47, slot: 0, fate: 'parent', particle: 20 },
  {
    type: 'compared',
    parent: 47,
    slot: 1,
    position: [0.1, 0.1732, -0.0025],
    against: 31,
    distance: 0.2,
    limit: 0.14,
    corresponds: false,
  },
  {
    type: 'added',
    particle: 74,
    data: { position: [0.1, 0.1732, -0.0025], normal: [0, 0, 1], radius: 0.1, parent: 47, level: 4, front: 0 },
  },
  { type: 'fate', parent: 47, slot: 1, fate: 'added', particle: 74 },
  {
    type: 'compared',
    parent: 47,
    slot: 2,
    position: [-0.1, 0.1732, 0],
    against: 31,
    distance: 0.012,
    limit: 0.14,
    corresponds: true,
  },
  { type: 'fate', parent: 47, slot: 2, fate: 'matched', particle: 31 },
  { type: 'done', particle: 47, evaluations: 1234 },
];
const subject = { particle: 47, level: 3, levels: 21, parent: 20, radius: 0.1 };
const last = events.length - 1;
/** @param {number} at */
const told = (at) => tell(momentAt(events, at), subject);

describe('the moment of an event', () => {
  test('holds what has happened up to it, and nothing later', () => {
    const before = momentAt(events, 3);
    expect(before.frame?.u).toEqual([1, 0, 0]);
    expect(before.gathered).toBe(null);
    expect(before.children[1].iterates).toHaveLength(1);
    expect(before.children[1].landed).toBe(null);
    expect(before.evaluations).toBe(1);
    const end = momentAt(events, last);
    expect(end.children.map(({ fate }) => fate)).toEqual(['parent', 'added', 'matched', 'open', 'open', 'open']);
    expect(end.children.map(({ particle }) => particle)).toEqual([20, 74, 31, null, null, null]);
    expect(end.evaluations).toBe(2);
  });

  test('is the same on the way back', () => {
    const forwards = events.map((_, at) => JSON.stringify(momentAt(events, at)));
    const backwards = events.map((_, at) => JSON.stringify(momentAt(events, last - at))).reverse();
    expect(backwards).toEqual(forwards);
  });

  test('speaks of the child that an added particle is', () => {
    const added = momentAt(events, 11);
    expect(added.event.type).toBe('added');
    expect(added.slot).toBe(1);
    expect(added.isNow).toBe(true);
    expect(added.children[1].particle).toBe(74);
    expect(momentAt(events, 8).isNow).toBe(false);
  });
});

describe('the words', () => {
  test('tell each event with its lengths in radii', () => {
    expect(told(1)).toContain('Slot 0 points to its parent, particle 20');
    expect(told(5)).toBe('The child of slot 1 lands on the surface, 2.000\u00a0r from its parent.');
    expect(told(4)).toContain('at θ₁ = −0.72°: f = ');
    expect(told(8)).toBe('1 particle within 4\u00a0r: the children are compared with it.');
    expect(told(10)).toContain(
      '2.000\u00a0r from particle 31, its nearest. That is more than the tolerance of 1.40\u00a0r',
    );
    expect(told(13)).toContain(
      '0.120\u00a0r from particle 31, its nearest. That is within the tolerance of 1.40\u00a0r',
    );
    expect(told(last)).toBe('The particle is done: 1 of its children added, 1 matched, after 2 evaluations of f.');
  });

  test('leave no event without a sentence and a line of the algorithm', () => {
    for (const [at, event] of events.entries()) {
      expect(told(at), event.type).toMatch(/^[A-Z\d].*\.$/);
      expect(lineOf(event), event.type).toBeGreaterThanOrEqual(0);
    }
    for (const fate of /** @type {const} */ (['not_converged', 'outside', 'undefined', 'capped'])) {
      const left = /** @type {LessonEvent} */ ({ type: 'fate', parent: 47, slot: 3, fate, particle: null });
      expect(tell(momentAt([...events, left], events.length), subject)).toMatch(/left out/);
      expect(ALGORITHM[lineOf(left)].text).toContain('leave it out');
    }
  });
});

describe('the geometry', () => {
  test('projects a place into the plane, in radii', () => {
    const plane = { centre: [1, 1, 1], right: [1, 0, 0], up: [0, 1, 0], radius: 0.5 };
    expect(inPlane(plane, [2, 0.5, 9])).toEqual([2, -1]);
  });

  test('puts the slots 60° apart at 2r', () => {
    for (let slot = 0; slot < 6; slot += 1) {
      const [[x, y], [u, v]] = [slotPlace(slot), slotPlace(slot + 1)];
      expect(Math.hypot(x, y)).toBeCloseTo(2);
      expect(Math.hypot(x - u, y - v)).toBeCloseTo(2);
    }
  });

  test('frames what is close together, and nothing that coincides', () => {
    const found = lensOf([
      [2, 0],
      [2, -0.01],
    ]);
    expect(found?.centre[1]).toBeCloseTo(-0.005);
    expect(found?.half).toBeGreaterThan(0.005);
    expect(lensOf([[2, 0]])).toBe(null);
    expect(
      lensOf([
        [2, 0],
        [Number.NaN, 0],
      ]),
    ).toBe(null);
  });
});

/**
 * An adaptive particle with two children: one is pushed into place and added, for the other there is no room.
 * @type {LessonEvent[]}
 */
const sized = [
  { type: 'taken', particle: 5 },
  { type: 'gathered', particle: 5, reach: 0.37, neighbours: [{ particle: 2, distance: 0.2 }] },
  { type: 'frame', particle: 5, normal: [0, 0, 1], u: [1, 0, 0], w: [0, 1, 0] },
  { type: 'fate', parent: 5, slot: 0, fate: 'parent', particle: 2 },
  { type: 'arc', parent: 5, before: 2, behind: 2, angles_rad: [0, 0] },
  { type: 'start', parent: 5, slot: 1, tangent: [0.2, 0.1, 0], position: [0.09, 0.045, 0], radius: 0.12 },
  { type: 'push', parent: 5, slot: 1, position: [0.18, 0.09, 0], radius: 0.1 },
  { type: 'push_on_circle', parent: 5, slot: 1, position: [0.1, 0.173, 0], radius: 0.1, overlap: -0.01 },
  { type: 'room', parent: 5, slot: 1, phi_rad: Math.PI / 3, tau_rad: Math.PI, fits: true },
  {
    type: 'iterate',
    parent: 5,
    slot: 1,
    step: 0,
    theta_rad: 0,
    position: [0.1, 0.173, 0],
    value: 1e-7,
    slope: 2,
  },
  { type: 'landed', parent: 5, slot: 1, position: [0.1, 0.173, 0], normal: [0, 0, 1], distance: 0.2 },
  { type: 'fate', parent: 5, slot: 1, fate: 'added', particle: 9 },
  { type: 'start', parent: 5, slot: 2, tangent: null, position: [-0.1, 0, 0], radius: 0.1 },
  { type: 'room', parent: 5, slot: 2, phi_rad: 1, tau_rad: 0.4, fits: false },
  { type: 'fate', parent: 5, slot: 2, fate: 'matched', particle: null },
  { type: 'done', particle: 5, evaluations: 300 },
];

describe('an adaptive particle', () => {
  const parent = { particle: 5, level: 1, parent: 2, radius: 0.1 };
  test('has as many slots as it tries, each with its way and its angles', () => {
    expect(isAdaptive(sized)).toBe(true);
    expect(isAdaptive(events)).toBe(false);
    const { children, arc } = momentAt(sized, sized.length - 1);
    expect(children.map(({ fate }) => fate)).toEqual(['parent', 'added', 'matched']);
    expect(children[1].pushes.map(({ type }) => type)).toEqual(['start', 'push', 'push_on_circle']);
    expect(children[1].start?.place).toEqual([0.1, 0.173, 0]);
    expect(children[2].room?.fits).toBe(false);
    expect(arc?.before).toBe(2);
    // Nothing is known before its event.
    expect(momentAt(sized, 6).children[1].pushes).toHaveLength(2);
    expect(momentAt(sized, 6).children[1].room).toBe(null);
  });

  test('is told event by event, with a line of the algorithm for each', () => {
    for (const [at, event] of sized.entries()) {
      const words = tell(momentAt(sized, at), parent);
      expect(words, event.type).toMatch(/^[A-Z\d].*\.$/);
      expect(lineOf(event, ADAPTIVE), event.type).toBeGreaterThanOrEqual(0);
    }
    const say = (/** @type {number} */ at) => tell(momentAt(sized, at), parent);
    expect(say(8)).toBe('The child of slot 1 takes φ = 60.0°; τ = 180.0° are free, 300 % of that. There is room.');
    expect(say(7)).toContain('It overlaps none any more.');
    expect(say(13)).toContain('There is no room');
    expect(say(14)).toBe('The child of slot 2 has no room and is not added.');
  });

  test('has discs at their true distances, and arcs of their width', () => {
    const plane = { centre: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], radius: 0.1 };
    const [x, y] = unrolled(plane, [0.16, 0, 0.12]);
    expect(x).toBeCloseTo(2);
    expect(y).toBeCloseTo(0);
    expect(widthOf([6, 1])).toBeCloseTo(2 * Math.PI - 5);
    expect(widthOf([2, 2])).toBeCloseTo(2 * Math.PI);
    const arc = arcOf(Math.PI / 2, Math.PI, 2);
    expect(arc[0][1]).toBeCloseTo(2);
    expect(arc.at(-1)?.[1]).toBeCloseTo(-2);
  });
});
