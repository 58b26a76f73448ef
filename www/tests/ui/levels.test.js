import { beforeAll, describe, expect, test } from 'vitest';
import { Columns, FATE, NO_PARENT } from '../../src/engine/columns.js';
import { setLocale } from '../../src/ui/format.js';
import { facing } from '../../src/ui/levels/facing.js';
import { describeLevel, flatCount, levelTable, shortOf } from '../../src/ui/levels/table.js';

beforeAll(() => setLocale('en-GB'));

/** Fates of slots as the core packs them. @param {(keyof typeof FATE)[]} fates */
const slots = (...fates) => fates.reduce((bits, fate, k) => (bits | (FATE[fate] << (3 * k))) >>> 0, 0);

/** @typedef {{ level: number, parent?: number, slots?: number }} Made */
/** @param {Made[]} made @param {boolean} [adaptive] */
function particles(made, adaptive = false) {
  const columns = new Columns();
  const n = made.length;
  columns.clear(adaptive);
  columns.write({
    first: 0,
    total: n,
    positions: new Float32Array(3 * n),
    normals: new Float32Array(3 * n),
    radii: new Float32Array(n).fill(1),
    levels: Uint32Array.from(made, ({ level }) => level),
    parents: Uint32Array.from(made, ({ parent }) => parent ?? NO_PARENT),
  });
  columns.writeSlots(
    0,
    Uint32Array.from(made, (m) => m.slots ?? 0),
  );
  return columns;
}

/** A seed, three children, and a particle that filled a gap at the end. */
const front = () =>
  particles([
    { level: 0, slots: slots('added', 'added', 'added', 'outside', 'outside', 'notConverged') },
    { level: 1, parent: 0, slots: slots('parent', 'matched', 'matched', 'matched', 'undefined', 'capped') },
    { level: 1, parent: 0, slots: slots('parent', 'matched') },
    { level: 1, parent: 0, slots: slots('parent', 'added', 'matched') },
    { level: 2, parent: 3 },
    { level: 2, parent: 3 },
  ]);

describe('the table of levels', () => {
  test('counts the particles of each level and of all up to it', () => {
    const table = levelTable(front());
    expect([...table.fresh]).toEqual([1, 3, 2]);
    expect([...table.total]).toEqual([1, 4, 6]);
    expect([...table.seeds]).toEqual([1, 0, 0]);
    expect(table).toMatchObject({ count: 6, last: 2 });
  });

  test('does not depend on the order of the particles', () => {
    const table = levelTable(particles([{ level: 0 }, { level: 2, parent: 2 }, { level: 1, parent: 0 }, { level: 0 }]));
    expect([...table.fresh]).toEqual([2, 1, 1]);
    expect([...table.seeds]).toEqual([2, 0, 0]);
  });

  test('holds one empty level where there is no particle', () => {
    expect(levelTable(new Columns())).toMatchObject({ count: 0, last: 0 });
  });

  test('reads all ten slots of an adaptive particle', () => {
    const ten = levelTable(
      particles(
        [
          { level: 0, slots: slots(...new Array(9).fill('matched'), 'added') },
          { level: 1, parent: 0 },
        ],
        true,
      ),
    );
    expect(ten.fates[8 + FATE.matched]).toBe(9);
    expect(ten.fates[8 + FATE.added]).toBe(1);
  });
});

describe('a level in words', () => {
  test('says how its children came about', () => {
    const table = levelTable(front());
    expect(describeLevel(table, 1, 0)).toEqual({
      title: 'Level 1 of 2 · 3 new (on a flat plane 6), 4 so far',
      text: 'Level 0 proposed 6 children: 3 added, 2 fell outside the box, 1 did not converge.',
    });
    expect(describeLevel(table, 2, 0).text).toBe(
      'Level 1 proposed 8 children: 1 added, 5 met existing particles, 1 was undefined, 1 was over the limit. 1 particle filled a gap at the end.',
    );
    expect(shortOf(table, 1)).toBe('Level 1 of 2: 3 particles, 4 so far');
  });

  test('says where a front starts, and that relaxation has moved it since', () => {
    expect(describeLevel(levelTable(front()), 0, 10)).toEqual({
      title: 'Level 0 of 2 · 1 new, 1 so far',
      text: 'The front starts at one point of the surface. Drawn after 10 relaxation steps.',
    });
    expect(describeLevel(levelTable(particles([{ level: 0 }, { level: 0 }])), 0, 0).text).toBe(
      '2 points of the surface, a front from each.',
    );
  });

  test('compares with a plane only where that means something: one front, one size', () => {
    const made = /** @type {Made[]} */ ([{ level: 0 }, { level: 1, parent: 0 }, { level: 2, parent: 1 }]);
    expect(flatCount(levelTable(particles(made)), 2)).toBe(12);
    expect(flatCount(levelTable(particles(made)), 0)).toBe(null);
    expect(flatCount(levelTable(particles(made, true)), 2)).toBe(null);
    expect(flatCount(levelTable(particles([...made, { level: 0 }])), 2)).toBe(null);
  });
});

describe('the turn to the seed', () => {
  const camera = { yaw: 0.5, pitch: 0.3 };
  test('leaves a seed that is seen where it is', () => {
    expect(facing(camera, [Math.cos(0.5) * Math.cos(0.3), Math.sin(0.5) * Math.cos(0.3), Math.sin(0.3)])).toBe(null);
  });

  test('faces one on the far side, the short way round', () => {
    for (const yaw of [-3, -1.5, 2, 3, 3.6, 4.5]) {
      const to = facing(camera, [Math.cos(yaw), Math.sin(yaw), 0]);
      if (!to) continue;
      expect(Math.abs(to.yaw - camera.yaw)).toBeLessThanOrEqual(Math.PI + 1e-9);
      expect(Math.cos(to.yaw - yaw)).toBeCloseTo(1);
      expect(to.pitch).toBeCloseTo(0);
    }
  });

  test('does not end at a pole', () => {
    const to = facing(camera, [0, 0, -1]);
    expect(to?.yaw).toBe(camera.yaw);
    expect(to?.pitch).toBeGreaterThan(-1);
    expect(to?.pitch).toBeLessThan(-0.5);
  });
});
