/** Room around a particle: how many others it has, and what the angles are. */
import { readFileSync } from 'node:fs';
import { expect, test } from 'vitest';
import { distance } from '../../../src/engine/vector.js';
import { FIT, roomEvents, takenAngle } from '../../../src/learn/room.js';

/** @import { LessonEvent, Vec3 } from '../../../src/engine/types.js' */

/** The events of one kind. @template {LessonEvent['type']} T @param {readonly LessonEvent[]} events @param {T} type */
const of = (events, type) =>
  /** @type {Extract<LessonEvent, { type: T }>[]} */ (events.filter((event) => event.type === type));

test('equal discs fit six times: each takes 60°, and after the last nothing is free', () => {
  expect(takenAngle(1, 1)).toBeCloseTo(Math.PI / 3, 12);
  const rooms = of(roomEvents(1, 1), 'room');
  expect(rooms.filter(({ fits }) => fits)).toHaveLength(5);
  expect(rooms.at(-1)).toMatchObject({ fits: false });
  expect(rooms.at(-1)?.tau_rad).toBeCloseTo(0, 9);
  expect(rooms[0].tau_rad).toBeCloseTo((5 * Math.PI) / 3, 9);
});

test('a large particle has room for more, a small one for fewer, and all of them touch it', () => {
  for (const [own, other] of [
    [1, 0.5],
    [1.25, 0.5],
    [0.5, 1.25],
    [0.9, 1.1],
    [1, 1],
  ]) {
    const events = roomEvents(own, other);
    const name = `${own} among ${other}`;
    const placed = 1 + of(events, 'room').filter(({ fits }) => fits).length;
    expect(placed, name).toBe(Math.floor((2 * Math.PI) / takenAngle(own, other) + FIT + 1e-9));
    expect(Math.sign(placed - 6), name).toBe(Math.abs(own - other) > 0.3 ? Math.sign(own - other) : placed - 6);
    const pushed = of(events, 'push_on_circle');
    for (const { position } of pushed) expect(distance(position, [0, 0, 0]), name).toBeCloseTo(own + other, 9);
    /** @type {Vec3[]} */
    const around = [[own + other, 0, 0], ...pushed.slice(0, placed - 1).map(({ position }) => position)];
    // Each touches the one before, except a last one that is squeezed in, which says by how much it overlaps.
    for (const [k, { overlap, position }] of pushed.slice(0, placed - 1).entries()) {
      const share = 1 - distance(position, around[k]) / (2 * other);
      expect(share, name).toBeCloseTo(overlap, 9);
      if (k < placed - 2) expect(overlap, name).toBe(0);
    }
  }
});

test('the share of its angle that a child needs is that of the runs', () => {
  expect(readFileSync(new URL('../../../../src/lesson/settings.rs', import.meta.url), 'utf8')).toContain(
    `fit: ${FIT.toFixed(1)},`,
  );
});
