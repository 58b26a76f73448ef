/** Edges of a mesh: their angles, which one a ray finds, the chains in which they go on, and their lines. */
import { describe, expect, test } from 'vitest';
import { MeshEdges } from '../../../src/ui/view/marks/mesh-edges.js';

/** @import { Line, Ray, Vec3 } from '../../../src/engine/types.js' */

/** @param {number[][]} vertices @param {number[][]} faces */
const meshOf = (vertices, faces) =>
  new MeshEdges({ vertices: Float64Array.from(vertices.flat()), faces: Uint32Array.from(faces.flat()) });

const SQUARES = [
  [0, 2, 3, 1],
  [4, 5, 7, 6],
  [0, 1, 5, 4],
  [2, 6, 7, 3],
  [0, 4, 6, 2],
  [1, 3, 7, 5],
];
/** A cube from −1 to 1, of two triangles a side; its top may be smaller. */
const cube = (top = 1) =>
  meshOf(
    [0, 1, 2, 3, 4, 5, 6, 7].map((k) => {
      const half = k & 4 ? top : 1;
      return [k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? 1 : -1];
    }),
    SQUARES.flatMap(([a, b, c, d]) => [
      [a, b, c],
      [a, c, d],
    ]),
  );

const SIDES = 12;
/** The height of the tip of a cone whose sides meet those of the prism below it at 20°. */
const TIP = Math.cos(Math.PI / SIDES) / Math.tan((20 * Math.PI) / 180);
/** A prism of twelve sides with a pointed roof; its rim has an angle of 20° where the roof is steep. */
function tower() {
  const ring = (/** @type {number} */ z) =>
    Array.from({ length: SIDES }, (_, k) => {
      const a = (2 * Math.PI * k) / SIDES;
      return [Math.cos(a), Math.sin(a), z];
    });
  const faces = Array.from({ length: SIDES }, (_, k) => {
    const next = (k + 1) % SIDES;
    return [
      [k, next, SIDES + next],
      [k, SIDES + next, SIDES + k],
      [SIDES + k, SIDES + next, 2 * SIDES],
      [2 * SIDES + 1, next, k],
    ];
  });
  return meshOf([...ring(0), ...ring(1), [0, 0, 1 + TIP], [0, 0, 0]], faces.flat());
}

/** The edges between two heights. @param {MeshEdges} mesh @param {number} low @param {number} high */
const between = (mesh, low, high) =>
  Array.from({ length: mesh.count }, (_, edge) => edge).filter((edge) => {
    const heights = mesh.placesOf(edge).map((place) => place[2]);
    return Math.min(...heights) === low && Math.max(...heights) === high;
  });

const degrees = (/** @type {number} */ angle) => (angle * 180) / Math.PI;
const everywhere = () => true;

describe('edges of a mesh', () => {
  test('have the angles between their faces; the diagonal of a square is none', () => {
    const mesh = cube();
    expect(mesh.count).toBe(18);
    const edges = Array.from({ length: mesh.count }, (_, edge) => edge).filter((edge) => mesh.isEdge(edge));
    expect(edges).toHaveLength(12);
    for (const edge of edges) expect(degrees(mesh.angleAt(edge))).toBeCloseTo(90, 9);
  });

  test('are concave where the faces turn inwards, and have no angle at a border or between three faces', () => {
    const roof = [
      [0, 0, 0],
      [0, 1, 0],
      [1, 0, -1],
      [-1, 0, -1],
      [0, 0, 1],
    ];
    const faces = [
      [0, 2, 1],
      [0, 1, 3],
    ];
    /** @type {Line} */
    const ridge = [
      [0, 0, 0],
      [0, 1, 0],
    ];
    const angleOf = (/** @type {MeshEdges} */ mesh) => degrees(mesh.angleAt([...mesh.edgesOf([ridge])][0]));
    expect(angleOf(meshOf(roof, faces))).toBeCloseTo(90, 9);
    expect(
      angleOf(
        meshOf(
          roof,
          faces.map((face) => face.toReversed()),
        ),
      ),
    ).toBeCloseTo(-90, 9);
    expect(angleOf(meshOf(roof, [...faces, [0, 1, 4]]))).toBe(0);
    expect(angleOf(meshOf(roof, [faces[0]]))).toBe(0);
  });

  test('are found by a ray, on the faces that are shown and seen', () => {
    const mesh = cube();
    /** Seen from above, a pixel is a hundredth. @param {Vec3} place */
    const project = ([x, y]) => ({ x: 100 * x, y: -100 * y });
    /** @param {number} x @param {number} y @returns {Ray} */
    const rayAt = (x, y) => ({ eye: [x, y, 9], direction: [0, 0, -1] });
    const near = (/** @type {number} */ x, /** @type {number} */ y) => {
      const { eye } = rayAt(x, y);
      const face = mesh.faceAt(rayAt(x, y), everywhere);
      return face === null ? null : mesh.edgeNear(face, project([x, y, 0]), { most: 12, eye, project });
    };
    const ends = mesh.placesOf(near(0.95, 0.2) ?? -1);
    expect(ends.toSorted((p, q) => p[1] - q[1])).toEqual([
      [1, -1, 1],
      [1, 1, 1],
    ]);
    expect(near(0.5, 0.5)).toBeNull();
    expect(near(1.5, 0)).toBeNull();
    const below = mesh.faceAt(rayAt(0.2, 0.1), ([, , z]) => z < 0) ?? -1;
    expect([...mesh.faces.subarray(3 * below, 3 * below + 3)].every((vertex) => vertex < 4)).toBe(true);
  });

  test('are meant before a blunter one that is nearer', () => {
    // Two edges from above: along y at 90°, and along x at 5° on its left.
    const low = -Math.sin((5 * Math.PI) / 180);
    const mesh = meshOf(
      [
        [0, -1, 0],
        [0, 0, 0],
        [0, 1, low],
        [-1, 0, 0],
        [0, 0, -1],
      ],
      [
        [0, 1, 3],
        [1, 2, 3],
        [0, 4, 1],
      ],
    );
    const project = (/** @type {Vec3} */ [x, y]) => ({ x: 100 * x, y: -100 * y });
    const meant = (/** @type {number} */ x, /** @type {number} */ y) => {
      const edge = mesh.edgeNear(0, project([x, y, 0]), { most: 12, eye: [x, y, 9], project });
      return edge === null ? null : Math.round(degrees(mesh.angleAt(edge)));
    };
    expect(meant(-0.08, -0.02)).toBe(90);
    expect(meant(-0.5, -0.02)).toBe(5);
    expect(meant(-0.5, -0.3)).toBeNull();
  });

  test('go on in chains: around a rim, but over no corner and into no other angle', () => {
    const mesh = tower();
    const rim = between(mesh, 1, 1);
    expect(rim).toHaveLength(SIDES);
    for (const edge of rim) expect(degrees(mesh.angleAt(edge))).toBeCloseTo(20, 9);
    for (const edge of rim) expect(mesh.chainOf(edge)).toEqual(new Set(rim));
    // A cube, and a pyramid without its top, whose mitres go on from its edges at 45°.
    for (const block of [cube(), cube(0.5)])
      for (let edge = 0; edge < block.count; edge += 1) expect(block.chainOf(edge).size).toBe(1);
  });

  test('are lines, from which the same edges are found', () => {
    const mesh = tower();
    const [rim, sides] = [between(mesh, 1, 1), between(mesh, 0, 1).filter((edge) => mesh.isEdge(edge))];
    expect(mesh.linesOf(rim).map((line) => line.length)).toEqual([SIDES + 1]);
    expect(mesh.linesOf(rim.slice(0, 3)).map((line) => line.length)).toEqual([4]);
    expect(mesh.linesOf([])).toEqual([]);
    // A wheel with spokes: every line ends where more than two edges meet.
    const wheel = [...rim, ...sides];
    const lines = mesh.linesOf(wheel);
    expect(lines.reduce((sum, line) => sum + line.length - 1, 0)).toBe(wheel.length);
    expect(mesh.edgesOf(lines)).toEqual(new Set(wheel));
    const moved = lines.map((line) => line.map(([x, y, z]) => /** @type {Vec3} */ ([x + 1e-6, y, z])));
    expect(mesh.edgesOf(moved), 'a line in single precision').toEqual(new Set(wheel));
    const away = lines.map((line) => line.map(([x, y, z]) => /** @type {Vec3} */ ([x + 1e-3, y, z])));
    expect(mesh.edgesOf(away), 'of another mesh').toEqual(new Set());
  });
});
