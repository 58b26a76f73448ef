import { expect, it } from 'vitest';
import { withoutChips } from '../../../src/engine/columns.js';

/** @import { Mesh } from '../../../src/engine/types.js' */

const body = (/** @type {number | null} */ volume, /** @type {boolean} */ isChip) =>
  /** @type {any} */ ({ volume, is_chip: isChip });
const component = (/** @type {number} */ of, openEdges = 0) => ({
  triangles: 1,
  euler: 2,
  open_edges: openEdges,
  body: of,
});
const mesh = (/** @type {object} */ about) =>
  /** @type {Mesh} */ (/** @type {unknown} */ ({ triangles: Uint32Array.from({ length: 15 }, (_, k) => k), about }));

it('the triangles of chips go, and what they added to the figures', () => {
  const { triangles, about, leavesOutChips } = withoutChips(
    mesh({
      chips: [0, 3],
      triangles: 5,
      volume: 7,
      loops: [],
      unfilled: 0,
      components: [component(1), component(0), component(0), component(2)],
      bodies: [body(6.5, false), body(0.3, true), body(0.2, true)],
    }),
  );
  expect([...triangles]).toEqual([3, 4, 5, 6, 7, 8, 12, 13, 14]);
  expect(about).toMatchObject({ triangles: 3, volume: 6.5, chips: [] });
  expect([about.components.length, about.bodies.length]).toEqual([2, 1]);
  expect(leavesOutChips).toBe(true);
});

it('a last triangle goes, too, and an open mesh has no volume', () => {
  const { triangles, about } = withoutChips(
    mesh({
      chips: [3, 4],
      volume: null,
      loops: [[0, 1, 2]],
      unfilled: 0,
      components: [component(0, 3), component(1)],
      bodies: [body(null, false), body(1, true)],
    }),
  );
  expect([...triangles]).toEqual([0, 1, 2, 3, 4, 5, 6, 7, 8]);
  expect(about.volume).toBeNull();
  expect(about.loops).toEqual([[0, 1, 2]]);
});

it('without an open chip a closed part has its volume, and no border', () => {
  const { about } = withoutChips(
    mesh({
      chips: [4],
      volume: null,
      loops: [[12, 13, 14]],
      unfilled: 1,
      components: [component(0), component(1, 3)],
      bodies: [body(5, false), body(null, true)],
    }),
  );
  expect(about).toMatchObject({ volume: 5, loops: [], unfilled: 0 });
});

it('a mesh whose parts touch stays without a volume', () => {
  const about = { volume: null, loops: [], unfilled: 0, components: [component(0), component(1)] };
  const bodies = [body(5, false), body(1, true)];
  expect(withoutChips(mesh({ chips: [4], ...about, bodies })).about.volume).toBeNull();
});
