/**
 * The edges of a triangle mesh: the one under a ray, the chain in which it goes on, and the lines of those that are
 * marked.
 */
import { along, clamp, cross, distance, dot, size, triple, unit, vec } from '../../../engine/vector.js';

/**
 * @import { Line, MeshFaces, Ray, Vec3 } from '../../../engine/types.js'
 * @import { Point } from '../types.js'
 */

const NONE = 0xffffffff;
/**
 * Largest angle between faces of one plane, in radians, as in src/remesh/patches.rs: the edge between them is none of
 * the surface.
 */
const BENT = 0.02;
/** A chain turns by less than this, around the rim of a prism of ten sides, but not into the mitre of a chamfer. */
const TURN_COS = Math.cos((40 * Math.PI) / 180);
/** Least angle between the faces at the next edge of a chain, as a share of that at the first. */
const FADING = 0.5;
/** Distance, as a share of the diagonal, within which a point of a line is a vertex, as in src/remesh/prepare.rs. */
const SAME = 2e-6;
/** Digits of a coordinate in a line: as many as a number in single precision needs. */
const DIGITS = 9;

export class MeshEdges {
  /** Number of edges. */
  count = 0;
  /** The two vertices of each edge. @type {Uint32Array} */
  ends;
  /** The two faces at each edge, the second {@link NONE} at a border and where more meet. */
  #wings;
  /** The edges at each vertex, and where those of each begin. @type {Uint32Array} */
  #around;
  /** @type {Uint32Array} */
  #first;

  /** @param {MeshFaces} mesh */
  constructor({ vertices, faces }) {
    this.vertices = vertices;
    this.faces = faces;
    this.diagonal = diagonalOf(vertices);
    this.ends = new Uint32Array(2 * faces.length);
    this.#wings = new Uint32Array(2 * faces.length).fill(NONE);
    this.#number();
    this.ends = this.ends.slice(0, 2 * this.count);
    this.#first = new Uint32Array(vertices.length / 3 + 1);
    this.#around = new Uint32Array(2 * this.count);
    this.#gather();
  }

  /** Numbers the edges, in the order in which the faces list them, with a table of open addresses. */
  #number() {
    const { faces, ends } = this;
    const wings = this.#wings;
    const bits = Math.max(4, Math.ceil(Math.log2(2 * faces.length)));
    const [table, last] = [new Uint32Array(2 ** bits).fill(NONE), 2 ** bits - 1];
    const met = new Uint8Array(faces.length);
    let count = 0;
    for (let side = 0; side < faces.length; side += 1) {
      const u = faces[side];
      const v = faces[side % 3 === 2 ? side - 2 : side + 1];
      const a = Math.min(u, v);
      const b = Math.max(u, v);
      let slot = (Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b)) >>> (32 - bits);
      let edge = table[slot];
      while (edge !== NONE && (ends[2 * edge] !== a || ends[2 * edge + 1] !== b)) {
        slot = (slot + 1) & last;
        edge = table[slot];
      }
      if (edge === NONE) {
        edge = count;
        table[slot] = edge;
        ends[2 * edge] = a;
        ends[2 * edge + 1] = b;
        count += 1;
      }
      if (met[edge] < 2) wings[2 * edge + met[edge]] = (side - (side % 3)) / 3;
      else wings[2 * edge + 1] = NONE;
      met[edge] = Math.min(3, met[edge] + 1);
    }
    this.count = count;
  }

  /** Lists the edges at each vertex. */
  #gather() {
    const { ends } = this;
    const [first, around] = [this.#first, this.#around];
    for (let k = 0; k < ends.length; k += 1) first[ends[k] + 1] += 1;
    for (let k = 1; k < first.length; k += 1) first[k] += first[k - 1];
    const next = first.slice();
    for (let k = 0; k < ends.length; k += 1) {
      around[next[ends[k]]] = k >> 1;
      next[ends[k]] += 1;
    }
  }

  /** @param {number} vertex */
  placeOf(vertex) {
    return triple(this.vertices, vertex);
  }

  /** Both ends of an edge. @param {number} edge @returns {[Vec3, Vec3]} */
  placesOf(edge) {
    return [this.placeOf(this.ends[2 * edge]), this.placeOf(this.ends[2 * edge + 1])];
  }

  /** @param {number} vertex */
  #edgesAt(vertex) {
    return this.#around.subarray(this.#first[vertex], this.#first[vertex + 1]);
  }

  /** @param {number} vertex @param {number} edge  at it */
  #otherEnd(vertex, edge) {
    return this.ends[2 * edge] === vertex ? this.ends[2 * edge + 1] : this.ends[2 * edge];
  }

  /** @param {number} face */
  #normalOf(face) {
    const [p, q, r] = [0, 1, 2].map((k) => this.placeOf(this.faces[3 * face + k]));
    return unit(cross(from(p, q), from(p, r)));
  }

  /**
   * Angle between the faces at an edge, in radians, negative where they turn inwards; 0 at a border and between more
   * than two faces.
   * @param {number} edge
   */
  angleAt(edge) {
    const [here, there] = this.#wings.subarray(2 * edge, 2 * edge + 2);
    if (there === NONE) return 0;
    const [m, n] = [this.#normalOf(here), this.#normalOf(there)];
    const angle = Math.atan2(size(cross(m, n)), dot(m, n));
    const [a, b] = this.ends.subarray(2 * edge, 2 * edge + 2);
    const apex = this.faces.subarray(3 * there, 3 * there + 3).find((vertex) => vertex !== a && vertex !== b) ?? a;
    return dot(m, from(this.placeOf(a), this.placeOf(apex))) > 0 ? -angle : angle;
  }

  /** Whether an edge is one of the surface, at which two faces meet that are not of one plane. @param {number} edge */
  isEdge(edge) {
    return Math.abs(this.angleAt(edge)) > BENT;
  }

  /**
   * The nearest face that a ray meets at a place that is shown; null if it meets none.
   * @param {Ray} ray @param {(place: Vec3) => boolean} isShown
   */
  faceAt({ eye, direction }, isShown) {
    const { faces, vertices } = this;
    const [dx, dy, dz] = direction;
    const [ex, ey, ez] = eye;
    let nearest = Infinity;
    let found = null;
    // The ray meets the plane of a face within it if both barycentric coordinates and their sum are from 0 to 1. One
    // pass over all faces takes some ten nanoseconds each, without an array in it.
    for (let k = 0; k < faces.length; k += 3) {
      const a = 3 * faces[k];
      const b = 3 * faces[k + 1];
      const c = 3 * faces[k + 2];
      const ax = vertices[a];
      const ay = vertices[a + 1];
      const az = vertices[a + 2];
      const ux = vertices[b] - ax;
      const uy = vertices[b + 1] - ay;
      const uz = vertices[b + 2] - az;
      const vx = vertices[c] - ax;
      const vy = vertices[c + 1] - ay;
      const vz = vertices[c + 2] - az;
      const px = dy * vz - dz * vy;
      const py = dz * vx - dx * vz;
      const pz = dx * vy - dy * vx;
      const scale = 1 / (ux * px + uy * py + uz * pz);
      const sx = ex - ax;
      const sy = ey - ay;
      const sz = ez - az;
      const first = (sx * px + sy * py + sz * pz) * scale;
      if (!(first >= 0 && first <= 1)) continue;
      const qx = sy * uz - sz * uy;
      const qy = sz * ux - sx * uz;
      const qz = sx * uy - sy * ux;
      const second = (dx * qx + dy * qy + dz * qz) * scale;
      if (!(second >= 0 && first + second <= 1)) continue;
      const t = (vx * qx + vy * qy + vz * qz) * scale;
      if (t > 0 && t < nearest && isShown(along(eye, direction, t))) {
        nearest = t;
        found = k / 3;
      }
    }
    return found;
  }

  /**
   * The edge around a face that is meant at a point in the picture, of those up to `most` pixels away that are seen
   * from an eye; null if there is none. A sharper one counts more, since smooth parts have edges everywhere.
   * @param {number} face @param {Point} at
   * @param {{ most: number, eye: Vec3, project: (place: Vec3) => Point | null }} seen
   */
  edgeNear(face, at, { most, eye, project }) {
    let best = { edge: -1, weight: 0 };
    for (const vertex of this.faces.subarray(3 * face, 3 * face + 3))
      for (const edge of this.#edgesAt(vertex)) {
        if (!this.isEdge(edge) || !this.isSeen(edge, eye)) continue;
        const [p, q] = this.placesOf(edge).map(project);
        const away = p && q ? awayFrom(at, p, q) : Infinity;
        const weight = Math.abs(this.angleAt(edge)) * (1 - away / most);
        if (weight > best.weight) best = { edge, weight };
      }
    return best.edge < 0 ? null : best.edge;
  }

  /** Whether a face at an edge is seen from a place. @param {number} edge @param {ArrayLike<number>} eye */
  isSeen(edge, eye) {
    const toEye = from(this.placeOf(this.ends[2 * edge]), eye);
    const faces = this.#wings.subarray(2 * edge, 2 * edge + 2).filter((face) => face !== NONE);
    return faces.some((face) => dot(this.#normalOf(face), toEye) > 0);
  }

  /**
   * The edges in which an edge goes on without a corner, with itself: on to the straightest of those whose faces bend
   * to the same side and not much less.
   * @param {number} edge
   */
  chainOf(edge) {
    const chain = new Set([edge]);
    for (const start of this.ends.subarray(2 * edge, 2 * edge + 2)) {
      let at = { edge, vertex: start };
      for (;;) {
        const next = this.#next(at.edge, at.vertex, this.angleAt(edge));
        if (next === null || chain.has(next)) break;
        chain.add(next);
        at = { edge: next, vertex: this.#otherEnd(at.vertex, next) };
      }
    }
    return chain;
  }

  /** @param {number} edge @param {number} vertex  its end @param {number} angle  at the first edge of the chain */
  #next(edge, vertex, angle) {
    const way = unit(from(this.placeOf(this.#otherEnd(vertex, edge)), this.placeOf(vertex)));
    let best = { edge: -1, cos: TURN_COS };
    for (const other of this.#edgesAt(vertex)) {
      const bends = this.isEdge(other) && this.angleAt(other) * Math.sign(angle) >= FADING * Math.abs(angle);
      if (other === edge || !bends) continue;
      const cos = dot(way, unit(from(this.placeOf(vertex), this.placeOf(this.#otherEnd(vertex, other)))));
      if (cos > best.cos) best = { edge: other, cos };
    }
    return best.edge < 0 ? null : best.edge;
  }

  /** The lines of some edges, each as long as it can be. @param {Iterable<number>} edges @returns {Line[]} */
  linesOf(edges) {
    /** @type {Map<number, number[]>} */
    const at = new Map();
    for (const edge of edges)
      for (const vertex of this.ends.subarray(2 * edge, 2 * edge + 2))
        at.set(vertex, [...(at.get(vertex) ?? []), edge]);
    const isEnd = (/** @type {number} */ vertex) => at.get(vertex)?.length !== 2;
    // A closed line begins anywhere, but one with ends at an end.
    const starts = [...at.keys()].sort((a, b) => Number(isEnd(b)) - Number(isEnd(a)) || a - b);
    const used = new Set();
    const next = (/** @type {number} */ vertex) => at.get(vertex)?.find((edge) => !used.has(edge));
    /** @type {Line[]} */
    const lines = [];
    for (const start of starts)
      while (next(start) !== undefined) {
        const line = [start];
        for (
          let edge = next(start);
          edge !== undefined;
          edge = isEnd(line[line.length - 1]) ? undefined : next(line[line.length - 1])
        ) {
          used.add(edge);
          line.push(this.#otherEnd(line[line.length - 1], edge));
        }
        lines.push(line.map((vertex) => vec((k) => Number(this.vertices[3 * vertex + k].toPrecision(DIGITS)))));
      }
    return lines;
  }

  /** The edges from point to point of some lines. @param {readonly Line[]} lines @returns {Set<number>} */
  edgesOf(lines) {
    const found = this.#verticesAt(lines.flat());
    const edges = new Set();
    let k = 0;
    for (const line of lines) {
      for (const [a, b] of line.slice(1).map((_, j) => [found[k + j], found[k + j + 1]])) {
        if (a < 0 || b < 0) continue;
        const edge = this.#edgesAt(a).find((own) => this.#otherEnd(a, own) === b);
        if (edge !== undefined) edges.add(edge);
      }
      k += line.length;
    }
    return edges;
  }

  /** The vertices at some points, −1 where there is none. @param {readonly Vec3[]} points */
  #verticesAt(points) {
    const { vertices } = this;
    const found = points.map(() => -1);
    if (points.length === 0) return found;
    const near = SAME * this.diagonal;
    const order = points.map((_, k) => k).sort((a, b) => points[a][0] - points[b][0]);
    for (let at = 0; at < vertices.length; at += 3) {
      let [low, high] = [0, order.length];
      while (low < high) {
        const middle = (low + high) >> 1;
        if (points[order[middle]][0] < vertices[at] - near) low = middle + 1;
        else high = middle;
      }
      for (; low < order.length && points[order[low]][0] <= vertices[at] + near; low += 1) {
        const point = points[order[low]];
        if (distance(point, triple(vertices, at / 3)) <= near) found[order[low]] = at / 3;
      }
    }
    return found;
  }
}

/** @param {ArrayLike<number>} p @param {ArrayLike<number>} q @returns the way from p to q */
const from = (p, q) => along(q, p, -1);

/** The length of the diagonal of a box around some vertices. @param {Float64Array} vertices */
function diagonalOf(vertices) {
  const [low, high] = [vec(() => Infinity), vec(() => -Infinity)];
  for (let k = 0; k < vertices.length; k += 1) {
    low[k % 3] = Math.min(low[k % 3], vertices[k]);
    high[k % 3] = Math.max(high[k % 3], vertices[k]);
  }
  return distance(low, high);
}

/** Distance of a point from the line between two others. @param {Point} at @param {Point} p @param {Point} q */
function awayFrom(at, p, q) {
  const [x, y] = [q.x - p.x, q.y - p.y];
  const share = clamp(((at.x - p.x) * x + (at.y - p.y) * y) / (x * x + y * y || 1), 0, 1);
  return Math.hypot(at.x - p.x - share * x, at.y - p.y - share * y);
}
