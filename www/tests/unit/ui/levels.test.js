import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { FATE, NO_PARENT } from '../../../src/engine/core-numbers.js';
import { facing } from '../../../src/engine/view/facing.js';
import { fatesOf, movesOf } from '../../../src/ui/levels/figures.js';
import { moveOf } from '../../../src/ui/levels/keys.js';
import { drawnAt, isOutOfSight, stepsOf, trackPlace } from '../../../src/ui/levels/levels.js';
import { BINS, degreeBins, hexagonalCount, nearestBins, nearestOver } from '../../../src/ui/levels/spread.js';
import { describeLevel, flatCount, levelTable, shortOf } from '../../../src/ui/levels/table.js';
import { spread } from '../../../src/ui/neighbours.js';

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
    { level: 0, slots: slots('added', 'added', 'added', 'outside', 'outside', 'not_converged') },
    { level: 1, parent: 0, slots: slots('parent', 'matched', 'matched', 'matched', 'undefined', 'capped') },
    { level: 1, parent: 0, slots: slots('parent', 'matched') },
    { level: 1, parent: 0, slots: slots('parent', 'added', 'matched') },
    { level: 2, parent: 3 },
    { level: 2, parent: 3 },
  ]);

/** The table by its definition, from all rows. @param {Columns} columns */
function countedAnew({ count, levels, parents, slots, twins }) {
  const last = levels.subarray(0, count).reduce((a, b) => Math.max(a, b), 0);
  const [fresh, seeds] = [new Array(last + 1).fill(0), new Array(last + 1).fill(0)];
  const fates = new Array(8 * (last + 2)).fill(0);
  for (let i = 0; i < count; i += 1) {
    if (i >= twins.length || twins[i] === i) {
      fresh[levels[i]] += 1;
      if (parents[i] === NO_PARENT) seeds[levels[i]] += 1;
    }
    for (let k = 0; k < 10; k += 1) fates[8 * (levels[i] + 1) + ((slots[i] >>> (3 * k)) & 7)] += 1;
  }
  return { last, fresh, seeds, fates };
}

describe('the table of levels', () => {
  test('is kept up to date as rows come, move, are settled, change and go', () => {
    const columns = new Columns();
    let seed = 1;
    const random = (/** @type {number} */ n) => {
      seed = (seed * 48_271) % 2_147_483_647;
      return seed % n;
    };
    /** @param {number} first @param {number} total @param {Uint32Array<ArrayBuffer>} [twins] */
    function write(first, total, twins) {
      const n = total - first;
      const creases = twins ? { twins, segments: new Uint32Array(0), seams: new Uint32Array(0) } : null;
      columns.write({
        first,
        total,
        positions: new Float32Array(3 * n),
        normals: new Float32Array(3 * n),
        radii: new Float32Array(n),
        levels: Uint32Array.from({ length: n }, () => random(9)),
        parents: Uint32Array.from({ length: n }, () => (random(5) === 0 ? NO_PARENT : 0)),
        creases,
      });
    }
    const settle = (/** @type {number} */ from) =>
      columns.writeSlots(
        from,
        Uint32Array.from({ length: columns.count - from }, () => random(2 ** 31)),
      );
    /** @param {string} what */
    function check(what) {
      const { last, fresh, seeds, fates } = levelTable(columns);
      const wanted = countedAnew(columns);
      expect([...fresh], what).toEqual(wanted.fresh);
      expect([...seeds], what).toEqual(wanted.seeds);
      expect([...fates].slice(0, wanted.fates.length), what).toEqual(wanted.fates);
      expect(last, what).toBe(wanted.last);
    }
    write(0, 50);
    check('first rows');
    settle(0);
    write(50, 3000);
    settle(20);
    check('more rows, and fates of earlier ones');
    // A relaxation sends all rows again; here nothing but a place has changed.
    const { tally } = columns;
    const [levels, parents] = [columns.levels.slice(0, 3000), columns.parents.slice(0, 3000)];
    const [positions, radii] = [new Float32Array(9000).fill(1), new Float32Array(3000)];
    columns.write({ first: 0, total: 3000, positions, normals: positions, radii, levels, parents });
    expect(columns.tally, 'not counted again').toBe(tally);
    check('moved');
    write(0, 3000);
    check('other rows');
    write(0, 40);
    check('fewer rows');
    write(40, 60, Uint32Array.from([0, 0, 2, 2]));
    check('creases');
    write(60, 70, Uint32Array.from([0, 0]));
    check('fewer creases');
    columns.clear();
    expect([...levelTable(columns).fresh]).toEqual([0]);
  });

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
    expect(describeLevel(levelTable(front()), 0, null).text).toBe(
      'The front starts at one point of the surface. Drawn as placed, before relaxation.',
    );
    expect(describeLevel(levelTable(particles([{ level: 0 }, { level: 0 }])), 0, 0).text).toBe(
      '2 points of the surface, a front from each.',
    );
  });

  test('says that the levels of blue noise are rounds, and that random points have none', () => {
    const drawn = (/** @type {any} */ pattern) => ({ ...levelTable(particles([{ level: 0 }, { level: 1 }])), pattern });
    expect(describeLevel(drawn('blue'), 1, 0)).toEqual({
      title: 'Round 1 of 1 · 1 new, 2 so far',
      text: 'Darts into the places that are still free, in random order.',
    });
    expect(shortOf(drawn('blue'), 0)).toBe('Round 0 of 1: 1 particle, 1 so far');
    expect(describeLevel(drawn('blue'), 0, 0).text).toMatch(/^Darts thrown/);
    expect(describeLevel(drawn('random'), 0, 0).text).toMatch(/^Points drawn one by one/);
  });

  test('compares with a plane only where that means something: one front, one size', () => {
    const made = /** @type {Made[]} */ ([{ level: 0 }, { level: 1, parent: 0 }, { level: 2, parent: 1 }]);
    expect(flatCount(levelTable(particles(made)), 2)).toBe(12);
    expect(flatCount(levelTable(particles(made)), 0)).toBe(null);
    expect(flatCount(levelTable(particles(made, true)), 2)).toBe(null);
    expect(flatCount(levelTable(particles([...made, { level: 0 }])), 2)).toBe(null);
  });
});

describe('the places of the timeline', () => {
  test('are the levels, then the relaxation steps, then everything', () => {
    const about = { last: 4, steps: 10 };
    expect(drawnAt(0, about)).toEqual({ level: 0, step: null });
    expect(drawnAt(4, about)).toEqual({ level: 4, step: null });
    expect(drawnAt(5, about)).toEqual({ level: null, step: 1 });
    expect(drawnAt(13, about)).toEqual({ level: null, step: 9 });
    expect(drawnAt(14, about)).toEqual({ level: null, step: null });
    for (let at = 0; at <= 14; at += 1) expect(trackPlace(drawnAt(at, about), about)).toBe(at);
  });

  test('end with everything where nothing is known of the relaxation', () => {
    const about = { last: 4, steps: stepsOf(0) };
    expect(drawnAt(5, about)).toEqual({ level: null, step: null });
    expect(trackPlace({ level: 99, step: null }, about)).toBe(4);
    expect(trackPlace({ level: null, step: 3 }, about)).toBe(5);
  });
});

describe('the figures of the charts', () => {
  test('are the fates that occur, by the level for which the children were proposed', () => {
    const rows = fatesOf(levelTable(front()));
    expect(rows.map(({ fate, counts }) => [fate, counts])).toEqual([
      ['added', [0, 3, 1]],
      ['matched', [0, 0, 5]],
      ['outside', [0, 2, 0]],
      ['not_converged', [0, 1, 0]],
      ['undefined', [0, 0, 1]],
      ['capped', [0, 0, 1]],
    ]);
  });

  test('are the longest move of each relaxation step, in radii', () => {
    const past = [Float32Array.of(0, 0, 0, 1, 0, 0), Float32Array.of(0.5, 0, 0, 1, 0, 0)];
    expect(movesOf(past, Float32Array.of(0.5, 0, 0, 1, 0, 1), Float32Array.of(1, 2))).toEqual([0.5, 0.5]);
    expect(movesOf([], new Float32Array(0), new Float32Array(0))).toEqual([]);
  });
});

describe('how even the particles are', () => {
  /** A number of its own for each place, the same on every run. */
  function scattered() {
    let state = 1;
    const next = () => {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      return state / 2 ** 32;
    };
    return Float32Array.from({ length: 600 }, next);
  }

  test('is the distance to the nearest of those that are shown, as a search of all pairs finds it', () => {
    const positions = scattered();
    const radii = Float32Array.from({ length: 200 }, (_, i) => 0.01 + 0.0002 * i);
    const chosen = Array.from({ length: 200 }, (_, i) => i).filter((i) => i % 3 !== 0);
    const found = nearestOver(positions, radii, chosen);
    for (const [k, i] of chosen.entries()) {
      const far = chosen
        .filter((j) => j !== i)
        .map((j) => Math.hypot(...[0, 1, 2].map((c) => positions[3 * i + c] - positions[3 * j + c])));
      expect(found[k]).toBeCloseTo(Math.min(...far) / (2 * radii[i]), 4);
    }
  });

  test('is not known of a particle that is alone', () => {
    const found = nearestOver(Float32Array.of(0, 0, 0, 99, 0, 0), Float32Array.of(0.5, 0.5), [0, 1]);
    expect([...found]).toEqual([Infinity, Infinity]);
    expect(nearestBins(found).reduce((a, b) => a + b)).toBe(0);
    expect(spread(found)).toMatchObject({ mean: 0, deviation: 0 });
    expect(spread([1, 3, Infinity])).toMatchObject({ mean: 2, deviation: 1 });
  });

  test('counts what is beyond the ends in the last bins', () => {
    const counts = nearestBins([0.1, 0.6, 1, 1.199, 7]);
    expect(counts).toHaveLength(BINS);
    expect(counts[0]).toBe(2);
    expect(counts[BINS - 1]).toBe(2);
    expect(counts[16]).toBe(1);
  });

  test('is compared with a hexagonal lattice, of which each disc has the hexagon around it', () => {
    // Three discs at mutual distances 2r share a triangle of half a hexagon's area.
    const [r, side] = [0.3, 0.6];
    expect(hexagonalCount(2 * (Math.sqrt(3) / 4) * side ** 2, r)).toBeCloseTo(1);
  });

  test('has the share of six among all, also those without neighbours', () => {
    expect(degreeBins(null)).toBe(null);
    const found = degreeBins(Uint8Array.of(6, 6, 5, 12, 1, 0, 255, 6));
    expect(found?.counts).toEqual([1, 0, 1, 3, 0, 0, 2]);
    expect(found?.six).toBe(3 / 8);
  });
});

describe('a key', () => {
  const none = { shiftKey: false, altKey: false, ctrlKey: false, metaKey: false };
  test('moves along the levels, upright arrows on the range alone', () => {
    expect(moveOf({ ...none, key: 'ArrowRight' }, false)).toBe(1);
    expect(moveOf({ ...none, key: 'ArrowLeft' }, true)).toBe(-1);
    expect(moveOf({ ...none, key: 'ArrowDown' }, true)).toBe(-1);
    expect(moveOf({ ...none, key: 'ArrowDown' }, false)).toBe(null);
  });

  test('of a clicker moves as the buttons do, and other keys mean nothing', () => {
    expect(moveOf({ ...none, key: 'PageDown' }, false)).toBe(1);
    expect(moveOf({ ...none, key: 'Home' }, false)).toBe('first');
    expect(moveOf({ ...none, key: 'ArrowRight', ctrlKey: true }, false)).toBe(null);
    expect(moveOf({ ...none, key: 'ArrowRight', shiftKey: true }, false)).toBe(null);
    expect(moveOf({ ...none, key: 'x' }, true)).toBe(null);
  });
});

describe('a level out of sight', () => {
  const particles = {
    count: 3,
    levels: Uint32Array.of(0, 1, 2),
    normals: Float32Array.of(-1, 0, 0, -0.8, 0.6, 0, 1, 0, 0),
  };
  test('is one whose particles all face away', () => {
    const camera = { yaw: 0, pitch: 0 };
    expect(isOutOfSight(particles, camera, 1)).toBe(true);
    expect(isOutOfSight(particles, camera, 2)).toBe(false);
    expect(isOutOfSight(particles, { yaw: Math.PI / 2, pitch: 0 }, 1)).toBe(false);
    expect(isOutOfSight({ ...particles, count: 0 }, camera, 1)).toBe(false);
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
