import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { FaceUpload, marksOf, valencesOf } from '../../../src/engine/view/faces.js';
import { PALETTES } from '../../../src/engine/view/palettes.js';
import { firstLook } from '../../../src/engine/view/style.js';

/** @import { Mesh } from '../../../src/engine/types.js' */

const TETRAHEDRON = Uint32Array.of(0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2);
/** `n` triangles around vertex 0. @param {number} n */
const fanOf = (n) => Uint32Array.from(Array.from({ length: n }, (_, k) => [0, 1 + k, 1 + ((k + 1) % n)]).flat());

/** @param {number} n */
function columnsOf(n) {
  const columns = new Columns();
  columns.write({
    first: 0,
    total: n,
    positions: Float32Array.from({ length: 3 * n }, (_, i) => i),
    normals: new Float32Array(3 * n),
    radii: Float32Array.from({ length: n }, (_, i) => 1 + i),
    levels: Uint32Array.from({ length: n }, (_, i) => i),
    parents: new Uint32Array(n),
  });
  return columns;
}

/** @param {Uint32Array} triangles @returns {Mesh} */
const meshOf = (triangles) => ({
  triangles,
  about: {
    triangles: triangles.length / 3,
    components: [],
    unfilled: 0,
    left_out: 0,
    volume: null,
    inside: null,
    smallest_angle: null,
    loops: [],
    bodies: [],
    chips: [],
  },
});

function device(most = 1000) {
  /** @type {any[][]} */
  const told = [];
  const note =
    (/** @type {string} */ name) =>
    (/** @type {any[]} */ ...rest) =>
      void told.push([name, ...rest]);
  const renderer = /** @type {any} */ ({
    max_faces: () => most,
    max_particles: () => most,
    write_faces: note('write'),
    tint_faces: note('tint'),
    set_faces: note('set'),
  });
  return { renderer, told, names: () => told.splice(0).map(([name]) => name) };
}

const look = (more = {}) => ({
  ...firstLook(
    /** @type {any} */ ({ colour: 'plain', size: 1, draw: 'mesh', faces: 'smooth', edges: true, marks: true }),
  ),
  ...more,
});
const present = { drawn: true, range: null };

describe('the faces of a mesh', () => {
  test('tell how many neighbours the vertices inside have, and nothing of those at a border', () => {
    expect([...valencesOf(TETRAHEDRON, 5)]).toEqual([3, 3, 3, 3, 0]);
    for (const n of [5, 6, 7]) expect([...valencesOf(fanOf(n), n + 1)]).toEqual([n, ...Array(n).fill(0)]);
    expect([...valencesOf(fanOf(6).subarray(3), 7)][0]).toBe(0);
  });

  test('are marked where there are not six, in the colours of the neighbours', () => {
    for (const theme of /** @type {const} */ (['light', 'dark'])) {
      const { five, seven } = PALETTES[theme].valence;
      expect(marksOf(fanOf(5), 6, theme)[0]).toBe(five);
      expect(marksOf(fanOf(6), 7, theme)[0]).toBe(0);
      expect(marksOf(fanOf(7), 8, theme)[0]).toBe(seven);
      expect(marksOf(fanOf(7), 8, theme)[1]).toBe(0);
    }
  });

  test('are uploaded once, with what each needs of its corners', () => {
    const columns = columnsOf(4);
    columns.mesh = meshOf(TETRAHEDRON);
    const faces = new FaceUpload(columns);
    const { renderer, told } = device();
    faces.write(renderer, look(), present);
    faces.write(renderer, look(), present);
    expect(told.map(([name]) => name)).toEqual(['write', 'set']);
    const [, first, positions, , radii, levels, colours, marks] = told[0];
    expect(first).toBe(0);
    expect([...positions.subarray(15, 18)]).toEqual([9, 10, 11]);
    expect([...radii.subarray(3, 6)]).toEqual([1, 3, 4]);
    expect([...levels.subarray(9)]).toEqual([1, 3, 2]);
    expect([colours.length, marks.length]).toEqual([12, 12]);
    expect(marks[0]).not.toBe(0);
    expect(told[1]).toEqual(['set', 4, 4]);
  });

  test('get other colours without their places, and go with the mesh, the way of drawing or the device', () => {
    const columns = columnsOf(4);
    columns.mesh = meshOf(TETRAHEDRON);
    const faces = new FaceUpload(columns);
    const { renderer, names, told } = device();
    faces.write(renderer, look(), present);
    names();
    faces.recolour();
    faces.write(renderer, look({ marks: false }), present);
    expect(told.at(-1)?.[3].every((/** @type {number} */ mark) => mark === 0)).toBe(true);
    expect(names()).toEqual(['tint']);
    faces.write(renderer, look(), { ...present, drawn: false });
    faces.write(renderer, look(), present);
    expect(names()).toEqual(['set', 'write', 'set']);
    faces.restart();
    faces.write(renderer, look(), present);
    expect(names()).toEqual(['write', 'set']);
    columns.forget();
    faces.write(renderer, look(), present);
    expect(told).toEqual([['set', 0, 0]]);
  });

  test('are not drawn where a device cannot hold them all', () => {
    const columns = columnsOf(4);
    columns.mesh = meshOf(TETRAHEDRON);
    const { renderer, told } = device(3);
    new FaceUpload(columns).write(renderer, look(), present);
    expect(told).toEqual([]);
  });

  test('are dropped when the particles change', () => {
    const columns = columnsOf(4);
    columns.mesh = meshOf(TETRAHEDRON);
    columns.writeSlots(0, new Uint32Array(4));
    expect(columns.mesh).not.toBe(null);
    const n = 1;
    columns.write({
      first: 0,
      total: 4,
      positions: new Float32Array(3 * n),
      normals: new Float32Array(3 * n),
      radii: new Float32Array(n),
      levels: new Uint32Array(n),
      parents: new Uint32Array(n),
    });
    expect(columns.mesh).toBe(null);
  });
});
