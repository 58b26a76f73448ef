import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { SINGULAR } from '../../../src/engine/core-numbers.js';
import { csv, json, ply } from '../../../src/engine/share/exports.js';
import { Glide } from '../../../src/engine/view/glide.js';
import { pick } from '../../../src/engine/view/picking.js';
import { Reveal } from '../../../src/engine/view/reveal.js';
import { description } from './description.js';

/** `n` particles on a sphere of radius 1, discs facing outward. @param {number} n */
function sphere(n) {
  const positions = new Float32Array(3 * n);
  for (let i = 0; i < n; i += 1) {
    const z = 1 - (2 * i + 1) / n;
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    const s = Math.sqrt(1 - z * z);
    positions.set([s * Math.cos(angle), s * Math.sin(angle), z], 3 * i);
  }
  const columns = new Columns();
  columns.write({
    first: 0,
    total: n,
    positions,
    normals: positions.slice(),
    radii: new Float32Array(n).fill(1.6 / Math.sqrt(n)),
    levels: Uint32Array.from({ length: n }, (_, i) => Math.floor(Math.sqrt(i))),
    parents: Uint32Array.from({ length: n }, (_, i) => (i === 0 ? 0xffffffff : i >> 1)),
  });
  return columns;
}

describe('columns', () => {
  test('take the curvature of particles in order, as far as it is known, until another run begins', () => {
    const columns = sphere(100);
    const values = (/** @type {number} */ from, /** @type {number} */ to) =>
      Float32Array.from({ length: 2 * (to - from) }, (_, i) => 2 * from + i);
    columns.writeCurvature(0, values(0, 60));
    expect(columns.curved).toBe(60);
    // A gap, and more than there are particles, are not taken.
    columns.writeCurvature(70, values(70, 100));
    columns.writeCurvature(60, values(60, 101));
    expect(columns.curved).toBe(60);
    columns.writeCurvature(60, values(60, 100));
    expect(columns.curved).toBe(100);
    expect(columns.curvature.subarray(0, 200)).toEqual(values(0, 100));
    columns.valence = new Uint8Array(100);
    columns.component = new Uint32Array(100);
    columns.clear(true);
    expect(columns).toMatchObject({ count: 0, curved: 0, adaptive: true, valence: null, component: null });
  });

  test('of no particle leave the figures of the report alone', () => {
    const columns = sphere(10);
    columns.valence = new Uint8Array(10);
    columns.write({
      first: 10,
      total: 10,
      positions: new Float32Array(0),
      normals: new Float32Array(0),
      radii: new Float32Array(0),
      levels: new Uint32Array(0),
      parents: new Uint32Array(0),
    });
    expect(columns.valence).not.toBe(null);
  });

  test('know their last level, also where the last particles are of an earlier one', () => {
    const columns = sphere(100);
    expect(columns.lastLevel).toBe(9);
    const one = {
      positions: new Float32Array(3),
      normals: new Float32Array(3),
      radii: new Float32Array(1),
      parents: new Uint32Array(1),
    };
    columns.write({ first: 100, total: 101, ...one, levels: Uint32Array.of(4) });
    expect(columns.lastLevel).toBe(9);
    columns.clear();
    expect(columns.lastLevel).toBe(0);
  });

  test('grow range by range and are overwritten in place', () => {
    const whole = sphere(5000);
    const columns = new Columns();
    const range = (/** @type {number} */ a, /** @type {number} */ b, total = b) => ({
      first: a,
      total,
      positions: whole.positions.slice(3 * a, 3 * b),
      normals: whole.normals.slice(3 * a, 3 * b),
      radii: whole.radii.slice(a, b),
      levels: whole.levels.slice(a, b),
      parents: whole.parents.slice(a, b),
    });
    for (let a = 0; a < 5000; a += 700) expect(columns.write(range(a, Math.min(5000, a + 700)))).toBe(true);
    expect(columns.count).toBe(5000);
    expect(columns.positions.subarray(0, 15_000)).toEqual(whole.positions.subarray(0, 15_000));
    expect(columns.levels.subarray(0, 5000)).toEqual(whole.levels.subarray(0, 5000));
    expect(columns.write(range(0, 100, 100))).toBe(true);
    expect(columns.count).toBe(100);
  });

  test('a range that does not fit is refused whole', () => {
    const columns = sphere(10);
    const before = columns.positions.slice();
    const three = new Float32Array(3).fill(9);
    const one = {
      positions: three,
      normals: three,
      radii: new Float32Array(1),
      levels: new Uint32Array(1),
      parents: new Uint32Array(1),
    };
    expect(columns.write({ first: 11, total: 12, ...one })).toBe(false);
    expect(columns.write({ first: 9, total: 9, ...one })).toBe(false);
    expect(columns.write({ first: 0, total: 1, ...one, normals: new Float32Array(6) })).toBe(false);
    expect(columns.count).toBe(10);
    expect(columns.positions).toEqual(before);
  });

  test('new positions make the figures of the report stale', () => {
    const columns = sphere(10);
    columns.valence = new Uint8Array(10);
    const three = new Float32Array(3);
    columns.write({
      first: 0,
      total: 10,
      positions: three,
      normals: three,
      radii: new Float32Array(1),
      levels: new Uint32Array(1),
      parents: new Uint32Array(1),
    });
    expect(columns.valence).toBe(null);
  });
});

describe('picking', () => {
  const columns = sphere(2000);
  /**
   * The definition: every disc of such a size, one by one.
   * @param {number[]} eye
   * @param {number[]} ray
   * @param {number} scale
   */
  function oracle(eye, ray, scale) {
    let best = null;
    let bestT = Infinity;
    for (let i = 0; i < columns.count; i += 1) {
      const p = [...columns.positions.subarray(3 * i, 3 * i + 3)];
      const n = [...columns.normals.subarray(3 * i, 3 * i + 3)];
      const dot = (/** @type {number[]} */ a, /** @type {number[]} */ b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      const t =
        dot(
          p.map((c, k) => c - eye[k]),
          n,
        ) / dot(ray, n);
      const hit = eye.map((e, k) => e + t * ray[k] - p[k]);
      if (t > 0 && t < bestT && dot(hit, hit) <= (columns.radii[i] * scale) ** 2) {
        bestT = t;
        best = i;
      }
    }
    return best;
  }

  /** @param {number} i @param {number} j */
  const apart = (i, j) =>
    Math.hypot(...[0, 1, 2].map((k) => columns.positions[3 * i + k] - columns.positions[3 * j + k]));

  /** Along the axis of the sphere, from below. @type {import('../../../src/engine/types.js').Ray} */
  const upwards = { eye: [0, 0, -5], direction: [0, 0, 1] };

  test('sees through particles of later levels', () => {
    const near = pick(columns, upwards, { discScale: 0.92, toleranceRad: 0 });
    expect(near).toBeGreaterThan(1900);
    // The sphere's levels go from the far pole to the near one.
    expect(pick(columns, upwards, { discScale: 0.92, toleranceRad: 0, lastLevel: 3 })).toBeLessThan(16);
    expect(pick(columns, upwards, { discScale: 0.92, toleranceRad: 0, lastLevel: columns.lastLevel })).toBe(near);
  });

  test('sees through particles beyond the cutting plane', () => {
    const plane = { normal: /** @type {[number, number, number]} */ ([0, 0, -1]), offset: 0 };
    const far = pick(columns, upwards, { discScale: 0.92, toleranceRad: 0, plane });
    expect(columns.positions[3 * (far ?? 0) + 2]).toBeGreaterThan(0.9);
    const all = { ...plane, offset: -2 };
    expect(pick(columns, upwards, { discScale: 0.92, toleranceRad: 0, plane: all })).toBe(null);
  });

  test('finds the sphere where it covers the picture beyond its disc', () => {
    // Past the pole by more than a radius, in the plane that touches the surface there.
    const i = pick(columns, upwards, { discScale: 1, toleranceRad: 0, spheres: true }) ?? 0;
    const [x, y, z] = columns.positions.subarray(3 * i, 3 * i + 3);
    const sideways = (/** @type {number} */ far) => ({
      eye: /** @type {[number, number, number]} */ ([-5, y, z - far * columns.radii[i]]),
      direction: /** @type {[number, number, number]} */ ([1, 0, 0]),
    });
    const options = { discScale: 1, toleranceRad: 0 };
    expect(x * x + y * y).toBeLessThan(0.01);
    expect(pick(columns, sideways(0.8), options)).toBe(null);
    expect(pick(columns, sideways(0.8), { ...options, spheres: true })).not.toBe(null);
    expect(pick(columns, sideways(1.2), { ...options, spheres: true })).toBe(null);
  });

  test('finds the disc that the definition finds, from anywhere, and in a gap one around it', () => {
    let hits = 0;
    let gaps = 0;
    for (let k = 0; k < 200; k += 1) {
      const eye = /** @type {[number, number, number]} */ ([4 * Math.cos(k), 4 * Math.sin(k), Math.sin(3 * k)]);
      const aim = [0.9 * Math.sin(7 * k), 0.9 * Math.cos(5 * k), 0.9 * Math.sin(11 * k)];
      const way = aim.map((a, i) => a - eye[i]);
      const length = Math.hypot(...way);
      const ray = /** @type {[number, number, number]} */ (way.map((w) => w / length));
      // Discs that leave much open hide nothing that lies behind them.
      const small = oracle(eye, ray, 0.6);
      expect(pick(columns, { eye, direction: ray }, { discScale: 0.6, toleranceRad: 0 }), `ray ${k}`).toBe(small);
      const best = oracle(eye, ray, 0.92);
      const front = oracle(eye, ray, 2 / Math.sqrt(3));
      const picked = pick(columns, { eye, direction: ray }, { discScale: 0.92, toleranceRad: 0 });
      if (front === null) {
        expect(picked, `ray ${k}`).toBe(null);
      } else if (best !== null && apart(best, front) <= 4 * columns.radii[0]) {
        hits += 1;
        expect(picked, `ray ${k}`).toBe(best);
      } else {
        // In a gap: a particle on this side, whatever is seen through it.
        gaps += 1;
        expect(picked, `ray ${k}`).not.toBe(null);
        expect(apart(picked ?? 0, front), `ray ${k}`).toBeLessThan(3 * columns.radii[0]);
      }
    }
    expect(hits).toBeGreaterThan(100);
    expect(gaps).toBeGreaterThan(5);
  });

  test('takes the nearest particle where discs are too small to hit, and nothing behind the eye', () => {
    const i = 700;
    const p = [...columns.positions.subarray(3 * i, 3 * i + 3)];
    const eye = /** @type {[number, number, number]} */ (p.map((c) => 3 * c));
    const ray = /** @type {[number, number, number]} */ (p.map((c) => -c));
    const length = Math.hypot(...ray);
    const unit = /** @type {[number, number, number]} */ (ray.map((c) => c / length));
    expect(pick(columns, { eye, direction: unit }, { discScale: 1e-6, toleranceRad: 0.002 })).toBe(i);
    const away = /** @type {[number, number, number]} */ (unit.map((c) => -c));
    expect(pick(columns, { eye, direction: away }, { discScale: 0.92, toleranceRad: 0.01 })).toBe(null);
  });
});

describe('exports', () => {
  test('hold the coordinates of a box far from the origin in double precision', async () => {
    const columns = sphere(20);
    const exact = Float64Array.from(columns.positions.subarray(0, 60), (v, i) => v + [100, -200, 300][i % 3] + 1e-9);
    const range = { positions: Float32Array.from(exact), normals: columns.normals.slice(0, 60) };
    const [radii, levels, parents] = [columns.radii, columns.levels, columns.parents].map((c) => c.slice(0, 20));
    columns.clear();
    for (const [first, total] of [
      [0, 12],
      [12, 20],
    ]) {
      const part = (/** @type {any} */ column, width = 1) => column.slice(width * first, width * total);
      const [positions, normals, places] = [range.positions, range.normals, exact].map((c) => part(c, 3));
      const rest = { radii: part(radii), levels: part(levels), parents: part(parents) };
      columns.write({ first, total, positions, normals, exact: places, ...rest });
    }
    const lines = (await csv(columns, description.columns).text()).trimEnd().split('\n').slice(1);
    expect(lines.flatMap((line) => line.split(',').slice(0, 3).map(Number))).toEqual([...exact]);
    const file = Buffer.from(await ply(columns, description.columns, null).arrayBuffer());
    const header = file.subarray(0, file.indexOf('end_header\n') + 'end_header\n'.length);
    expect(header.toString()).toContain('property double x\nproperty double y\nproperty double z\nproperty float nx');
    const stride = (file.length - header.length) / 20;
    const first = (/** @type {number} */ i) => file.readDoubleLE(header.length + i * stride);
    expect([0, 7, 19].map(first)).toEqual([0, 7, 19].map((i) => exact[3 * i]));
    // The next run may be near the origin.
    columns.clear();
    expect(columns.exact).toHaveLength(0);
  });

  test('PLY: header and body agree, to the byte', async () => {
    const evil = /** @type {any} */ ({ formula: `x^2\nend_header\n<π> & ü ${'ab cde  '.repeat(200)}`, link: null });
    const columns = sphere(50);
    columns.valence = Uint8Array.from({ length: 50 }, (_, i) => 4 + (i % 4));
    columns.nearest = new Float32Array(50).fill(0.25);
    columns.residual = new Float32Array(50).fill(1e-6);
    columns.slots[17] |= SINGULAR;
    const bytes = await ply(columns, description.columns, evil).arrayBuffer();
    const text = Buffer.from(bytes).toString('latin1');
    const comments = text.slice(0, text.indexOf('element')).split('\n').slice(3, -1);
    const start = 'comment marching_particles ';
    // MeshLab reads lines of up to 512 characters.
    expect(comments.every((line) => line.startsWith(start) && line.length <= 200 && !line.endsWith(' '))).toBe(true);
    expect(comments.length).toBeGreaterThan(5);
    const record = comments.map((line) => line.slice(start.length)).join('');
    expect(JSON.parse(record)).toEqual(evil);
    expect(JSON.parse(await json(evil).text())).toEqual({ marching_particles: evil });
    expect(record).toMatch(/^[ -%'-;=?-~]*$/);
    const end = text.indexOf('end_header\n', text.indexOf('element vertex')) + 'end_header\n'.length;
    const header = text.slice(0, end).trimEnd().split('\n');
    expect(header.filter((line) => line === 'end_header')).toHaveLength(1);
    expect(header.slice(0, 2)).toEqual(['ply', 'format binary_little_endian 1.0']);
    expect(header).toContain('element vertex 50');
    const properties = header.filter((line) => line.startsWith('property')).map((line) => line.split(' '));
    const width = /** @type {Record<string, number>} */ ({ float: 4, uint: 4, int: 4, uchar: 1 });
    const stride = properties.reduce((sum, [, type]) => sum + width[type], 0);
    expect(bytes.byteLength).toBe(end + 50 * stride);
    const view = new DataView(bytes, end);
    for (const i of [0, 1, 17, 49]) {
      let at = i * stride;
      /** @type {Record<string, number>} */
      const row = {};
      for (const [, type, name] of properties) {
        if (type === 'float') row[name] = view.getFloat32(at, true);
        else if (type === 'uint') row[name] = view.getUint32(at, true);
        else if (type === 'int') row[name] = view.getInt32(at, true);
        else row[name] = view.getUint8(at);
        at += width[type];
      }
      expect(row).toEqual({
        x: columns.positions[3 * i],
        y: columns.positions[3 * i + 1],
        z: columns.positions[3 * i + 2],
        nx: columns.normals[3 * i],
        ny: columns.normals[3 * i + 1],
        nz: columns.normals[3 * i + 2],
        radius: columns.radii[i],
        level: columns.levels[i],
        parent: i === 0 ? -1 : i >> 1,
        valence: 4 + (i % 4),
        nearest: 0.25,
        residual: Math.fround(1e-6),
        singular: i === 17 ? 1 : 0,
      });
    }
  });

  test('CSV has the columns of patches where there are creases', async () => {
    const columns = sphere(3);
    columns.patch = Uint32Array.of(4, 9, 9);
    columns.particle = Uint32Array.of(0, 0, 2);
    const lines = (await csv(columns, description.columns).text()).trimEnd().split('\n');
    expect(lines[0]).toMatch(/,singular,patch,particle$/);
    expect(lines.slice(1).map((line) => line.split(',').slice(-2).map(Number))).toEqual([
      [4, 0],
      [9, 0],
      [9, 2],
    ]);
  });

  test('PLY without a report has no column of it', async () => {
    const text = await ply(sphere(3), description.columns, null).text();
    expect(text).not.toMatch(/valence|nearest|residual/);
  });

  test('CSV: reading it gives the same single-precision values, on both sides of a block', async () => {
    const columns = sphere(9000);
    columns.slots[8191] |= SINGULAR;
    const lines = (await csv(columns, description.columns).text()).trimEnd().split('\n');
    expect(lines).toHaveLength(9001);
    expect(lines[0]).toBe('x,y,z,nx,ny,nz,radius,level,parent,singular');
    for (const i of [0, 8191, 8192, 8999]) {
      const row = lines[i + 1].split(',').map(Number);
      expect(row.slice(0, 3).map(Math.fround)).toEqual([...columns.positions.subarray(3 * i, 3 * i + 3)]);
      expect(row.slice(7)).toEqual([columns.levels[i], i === 0 ? -1 : i >> 1, i === 8191 ? 1 : 0]);
    }
  });
});

describe('motion', () => {
  test('a glide leaves from where the particles were drawn and arrives where they are', () => {
    const glide = new Glide();
    glide.note(Float32Array.of(0, 0, 0, 1, 1, 1), 0, 2);
    glide.begin(10);
    const goal = Float32Array.of(1, 0, 0, 1, 1, 3, 7, 7, 7);
    expect([...glide.between(goal, 3, 10)]).toEqual([0, 0, 0, 1, 1, 1, 7, 7, 7]);
    const half = glide.between(goal, 3, 10.05);
    expect(half[0]).toBeGreaterThan(0.5);
    expect(half[0]).toBeLessThan(1);
    expect(glide.active).toBe(true);
    expect([...glide.between(goal, 3, 10.2)]).toEqual([...goal]);
    expect(glide.active).toBe(false);
  });

  test('levels appear in order, never before they are known, and a slow run is not held back', () => {
    const reveal = new Reveal();
    expect(reveal.birthOf(3, 0)).toBe(-Infinity);
    reveal.begin(100);
    const births = [0, 1, 2, 3].map((level) => reveal.birthOf(level, 100));
    expect(births[0]).toBe(100);
    for (let k = 1; k < 4; k += 1) expect(births[k]).toBeGreaterThan(births[k - 1]);
    expect(reveal.birthOf(2, 500)).toBe(births[2]);
    expect(reveal.birthOf(4, 500)).toBe(500);
    expect(reveal.levelAt(births[2])).toBe(2);
    expect(reveal.levelAt(99)).toBe(-1);
    expect(reveal.endS()).toBe(500);
  });

  test('the first surface of a visit grows for two to three seconds, and waits for slow frames, but not for ever', () => {
    const reveal = new Reveal();
    expect(reveal.wait(1)).toBe(0);
    reveal.begin(100, true);
    // Before its front is there, it does not begin.
    expect(reveal.wait(0.5)).toBe(0);
    reveal.release(
      100,
      Uint32Array.from({ length: 56 }, (_, k) => k),
    );
    const step = reveal.birthOf(1, 100) - 100;
    expect(reveal.birthOf(55, 100) - 100).toBeGreaterThan(2.5);
    expect(reveal.birthOf(55, 100) - 100).toBeLessThan(3);
    expect(reveal.wait(1 / 60)).toBe(0);
    expect(reveal.wait(0.5)).toBeCloseTo(0.5 - 2 * step, 9);
    let waited = 0;
    for (let k = 0; k < 100; k += 1) waited += reveal.wait(0.5);
    expect(waited).toBeLessThan(2);
  });
});
