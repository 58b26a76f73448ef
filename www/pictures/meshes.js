/** Triangle meshes whose pictures before and after sampling stand in docs/results.md, as OFF files. */

/** @typedef {[number, number, number]} Triple */
/** @typedef {{ vertices: Triple[], faces: Triple[] }} Shape */

/** @param {number} n @returns the angles of a regular polygon */
const angles = (n) => Array.from({ length: n }, (_, k) => (2 * Math.PI * k) / n);

/**
 * The solid between two closed curves of equally many points.
 * @param {[number, number][]} outer @param {[number, number][]} inner @param {number} height
 * @returns {Shape}
 */
function between(outer, inner, height) {
  const n = outer.length;
  const rings = [
    [0, inner],
    [0, outer],
    [height, inner],
    [height, outer],
  ];
  const vertices = rings.flatMap(([z, ring]) =>
    /** @type {[number, number][]} */ (ring).map(([x, y]) => /** @type {Triple} */ ([x, y, z])),
  );
  /** @type {Triple[]} */
  const faces = [];
  for (let i = 0; i < n; i += 1) {
    const [a, b, c, d] = [0, 1, 2, 3].map((ring) => ring * n + i);
    const [e, f, g, h] = [0, 1, 2, 3].map((ring) => ring * n + ((i + 1) % n));
    faces.push([c, d, h], [c, h, g], [a, f, b], [a, e, f], [b, f, h], [b, h, d], [a, g, e], [a, c, g]);
  }
  return { vertices, faces };
}

/** @param {number} radius @param {number} n @returns {[number, number][]} */
const circle = (radius, n) => angles(n).map((t) => [radius * Math.cos(t), radius * Math.sin(t)]);

function drilled() {
  const square = angles(64).map((t) => {
    const size = Math.max(Math.abs(Math.cos(t)), Math.abs(Math.sin(t)));
    return /** @type {[number, number]} */ ([Math.cos(t) / size, Math.sin(t) / size]);
  });
  return between(square, circle(0.5, 64), 0.9);
}

function nut() {
  const sides = angles(6).map((t) => t + Math.PI / 6);
  const hexagon = angles(48).map((t) => {
    const width = Math.max(...sides.map((side) => Math.cos(t - side)));
    return /** @type {[number, number]} */ ([Math.cos(t) / width, Math.sin(t) / width]);
  });
  return between(hexagon, circle(0.55, 48), 0.8);
}

/** An angle with a fillet of eight steps between its legs. @returns {Shape} */
function bracket() {
  const outline = [
    [0, 0],
    [2, 0],
    [2, 0.5],
  ];
  for (let k = 0; k <= 8; k += 1) {
    const t = (Math.PI / 2) * (k / 8);
    outline.push([0.8 - 0.3 * Math.sin(t), 0.8 - 0.3 * Math.cos(t)]);
  }
  outline.push([0.5, 2], [0, 2]);
  const n = outline.length;
  const vertices = [0, 1].flatMap((z) => outline.map(([x, y]) => /** @type {Triple} */ ([x, y, z])));
  /** @type {Triple[]} */
  const faces = [];
  for (let i = 0; i < n; i += 1) {
    const k = (i + 1) % n;
    faces.push([i, k, n + k], [i, n + k, n + i]);
    if (i > 0 && i < n - 1) faces.push([0, i + 1, i], [n, n + i, n + i + 1]);
  }
  return { vertices, faces };
}

/** A rough ball like a scan, whose triangles differ in size. @returns {Shape} */
function asteroid() {
  const [rows, columns] = [44, 72];
  /** @type {Triple[]} */
  const vertices = [];
  /** @param {number} v @param {number} u */
  const add = (v, u) => {
    const way = [Math.sin(v) * Math.cos(u), Math.sin(v) * Math.sin(u), Math.cos(v)];
    let height = 0;
    for (let k = 1; k <= 12; k += 1) {
      const wave = [Math.sin(7.1 * k), Math.sin(13.7 * k + 1), Math.sin(3.3 * k + 2)];
      height += Math.cos(4 * wave.reduce((sum, own, axis) => sum + own * way[axis], 0)) / 40;
    }
    const radius = 1 + height;
    vertices.push([1.25 * radius * way[0], radius * way[1], 0.9 * radius * way[2]]);
  };
  add(0, 0);
  for (let i = 1; i < rows; i += 1)
    for (let j = 0; j < columns; j += 1) add((Math.PI * i) / rows, (2 * Math.PI * (j + (i % 2) / 2)) / columns);
  add(Math.PI, 0);
  /** @param {number} i @param {number} j */
  const at = (i, j) => 1 + (i - 1) * columns + ((j + columns) % columns);
  /** @type {Triple[]} */
  const faces = [];
  for (let j = 0; j < columns; j += 1) {
    faces.push([0, at(1, j), at(1, j + 1)]);
    faces.push([vertices.length - 1, at(rows - 1, j + 1), at(rows - 1, j)]);
    for (let i = 1; i < rows - 1; i += 1) {
      const odd = i % 2;
      faces.push(
        [at(i, j), at(i + 1, j + odd), at(i, j + 1)],
        [at(i + 1, j + odd), at(i + 1, j + odd + 1), at(i, j + 1)],
      );
    }
  }
  return { vertices, faces };
}

/** @param {Shape} shape */
const offOf = ({ vertices, faces }) =>
  [
    'OFF',
    `${vertices.length} ${faces.length} 0`,
    ...vertices.map((place) => place.join(' ')),
    ...faces.map((face) => `3 ${face.join(' ')}`),
    '',
  ].join('\n');

/** Names and contents of the files, and from where they are seen. */
export const MESH_FILES = [
  { name: 'drilled', shape: drilled(), pitch: 0.8 },
  { name: 'bracket', shape: bracket(), pitch: 0.9 },
  { name: 'nut', shape: nut(), pitch: 0.8 },
  { name: 'asteroid', shape: asteroid(), pitch: 0.9 },
].map(({ name, shape, pitch }) => ({ name: `${name}.off`, text: offOf(shape), camera: { yaw: 0.45, pitch } }));
