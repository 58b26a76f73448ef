/** The packed package in Node: its examples, what it gives, and what it says of bad input. */
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, readFileSync, renameSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { afterAll, beforeAll, describe, expect, test, vi } from 'vitest';
import { GYROID, install, programOf, ROUND } from './packed.js';

const { runs } = JSON.parse(readFileSync(new URL('../../../tests/golden/digests.json', import.meta.url), 'utf8'));
const golden = runs.find((/** @type {{name: string}} */ { name }) => name === GYROID.golden);

const SPHERE = 'x^2 + y^2 + z^2 = a';
/** @type {ReturnType<typeof install>} */
let there;
/** @type {typeof import('../../package/index.js')} */
let made;

beforeAll(async () => {
  there = install(['three', '@types/node', '@types/three']);
  made = await there.module();
}, 120_000);
afterAll(() => there.remove());

test('a program in Node gets the particles of the native library, and ends', () => {
  const program = there.write('program.js', programOf('console.log'));
  expect(execFileSync(process.execPath, [program], { encoding: 'utf8' }).trim()).toBe(golden.digest);
});

test('every setting of the core is an option', async () => {
  const kept = readFileSync(new URL('../../../docs/settings.md', import.meta.url), 'utf8');
  const names = [...kept.matchAll(/^(?:\|[^|]*){3}\| `(\w+)` \|/gm)].map(([, name]) => name);
  expect(names.length).toBeGreaterThan(20);
  const known = await made.sample('x', /** @type {any} */ ({ none: 1 })).catch(({ message }) => message);
  for (const name of names) expect(known.split(/[ ,.]+/)).toContain(name);
});

test('gaps that the mesh closes are none', async () => {
  const tubes = '(x^2 + y^2 + z^2 - 2)^3 + 2000(x^2y^2 + x^2z^2 + y^2z^2) = 10';
  const sample = await made.sample(tubes, { count: 5000 });
  expect(sample.report).toMatchObject({ components: 1 });
  expect(sample.warnings.map(({ code }) => code)).not.toContain('open');
  sample.dispose();
});

test('a file of particles and a file of the mesh', async () => {
  const ball = await made.sample(SPHERE, { count: 300, params: { a: 1 } });
  const text = async (/** @type {Promise<Uint8Array>} */ file) => new TextDecoder('latin1').decode(await file);
  const points = await text(ball.toFile('ply'));
  expect(points).toContain(`element vertex ${ball.count}\n`);
  expect(points).not.toContain('element face');
  expect(points).toContain('comment marching_particles {');
  expect(await text(ball.toFile('ply', { mesh: true }))).toContain('element face');
  expect((await text(ball.toFile('csv'))).split('\n').length).toBe(ball.count + 2);
  await expect(ball.toFile('csv', { mesh: true })).rejects.toMatchObject({ name: 'InputError' });
  const [row] = (await text(ball.toFile('xyz'))).split('\n');
  const first = [...ball.points.slice(0, 3), ...ball.normals.slice(0, 3)];
  expect(row.split(' ').map((number) => Math.fround(Number(number)))).toEqual(first);
  expect(await text(ball.toFile('npy'))).toContain(`'<f4', 'fortran_order': False, 'shape': (${ball.count}, 6)`);
});

test('a word that is nearly an option, and a path in place of a formula, are told what to do', async () => {
  const refused = (/** @type {any} */ field, /** @type {any} */ options) =>
    made.sample(field, options).catch((error) => String(error));
  expect(await refused(SPHERE, { cuont: 300 })).toBe('InputError: cuont: there is no such option. Did you mean count?');
  expect(await refused(SPHERE, { chord_error: 0.1 })).toContain('Did you mean chordError?');
  expect(await refused('scan.ply', {})).toContain('is given by its bytes, as {points}, {mesh} or {image}');
});

test('the ending of a path decides what is saved', async () => {
  const ball = await made.sample(SPHERE, { count: 300, params: { a: 1 } });
  const at = (/** @type {string} */ name) => join(there.project, name);
  for (const name of ['ball.xyz', 'ball.npy', 'ball.csv', 'ball.STL', 'ball.ply']) await ball.save(at(name));
  expect(new Uint8Array(readFileSync(at('ball.npy')))).toEqual(await ball.toFile('npy'));
  expect(readFileSync(at('ball.STL')).length).toBe((await ball.toFile('stl')).length);
  expect(JSON.parse(readFileSync(at('ball.csv.json'), 'utf8')).marching_particles).toMatchObject({
    formula: SPHERE,
    digest: ball.digest,
  });
  await ball.save(at('mesh.ply'), { mesh: true });
  expect(readFileSync(at('mesh.ply'), 'latin1')).toContain('element face');
  await expect(ball.save(at('ball'))).rejects.toThrow('a name with an ending');
  await expect(ball.save(at('ball.doc'))).rejects.toThrow('one of glb, 3mf, stl, obj, ply, csv, npy, xyz');
  await expect(ball.save(at('none/ball.ply'))).rejects.toThrow('its folder does not exist');
  const round = await made.sample((x, y, z) => x * x + y * y + z * z - 1, { count: 300 });
  await round.save(at('round.csv'));
  expect(existsSync(at('round.csv.json'))).toBe(false);
});

describe('an image', () => {
  const Side = 32;
  const Middle = [15.3, 15.6, 15.1];
  const fromMiddle = (/** @type {number} */ at) => {
    const p = [at % Side, Math.floor(at / Side) % Side, Math.floor(at / Side ** 2)];
    return Math.hypot(...p.map((v, k) => v - Middle[k]));
  };
  const size = /** @type {[number, number, number]} */ ([Side, Side, Side]);
  const ball = Int16Array.from({ length: Side ** 3 }, (_, at) => Math.round(100 * (10 - fromMiddle(at))));

  test('of an array is the surface at its iso value, where its spacing and origin put it', async () => {
    const origin = /** @type {[number, number, number]} */ ([7, -3, 100]);
    const made5 = await made.sample({ image: ball, size, spacing: 0.5, origin }, { iso: 200, smooth: 0, count: 600 });
    expect(made5.image).toMatchObject({ size, iso: 200, smooth: 0, label: null, is_dark_inside: false });
    expect(made5.params).toEqual({ iso: 200, smooth: 0 });
    for (let i = 0; i < made5.points.length; i += 3) {
      const out = [0, 1, 2].map((k) => made5.points[i + k] - origin[k] - 0.5 * Middle[k]);
      expect(Math.abs(Math.hypot(...out) - 4)).toBeLessThan(0.01);
      const along = out.reduce((sum, v, k) => sum + v * made5.normals[i + k], 0) / 4;
      expect(along).toBeGreaterThan(0.99);
    }
    const affine = [0, 1, 2].map((r) => [...[0, 1, 2].map((c) => (r === c ? 0.5 : 0)), origin[r]]);
    const same = await made.sample({ image: ball, size, affine }, { iso: 200, smooth: 0, count: 600 });
    expect(same.digest).toBe(made5.digest);
  });

  test('of a file is that of its array, in a blob, a buffer or its bytes', async () => {
    const header = `${"{'descr': '<i2', 'fortran_order': True, 'shape': (32, 32, 32), }".padEnd(117)}\n`;
    const magic = Uint8Array.from([0x93, ...new TextEncoder().encode('NUMPY'), 1, 0, header.length, 0]);
    const file = new Blob([magic, header, ball]);
    const options = /** @type {const} */ ({ iso: 0, count: 500 });
    const { digest, warnings } = await made.sample({ image: ball, size }, options);
    expect(warnings).toEqual([]);
    const buffer = await file.arrayBuffer();
    for (const image of [file, buffer, new Uint8Array(buffer)])
      expect((await made.sample({ image }, options)).digest).toBe(digest);
  });

  test('moves to another iso value, to the surface that a sampling there has', async () => {
    const first = await made.sample({ image: ball, size }, { iso: 0, count: 600 });
    const moved = await first.moved({ iso: 10 });
    expect(moved.params.iso).toBe(10);
    for (let i = 0; i < moved.points.length; i += 3) {
      const out = [0, 1, 2].map((k) => moved.points[i + k] - Middle[k]);
      expect(Math.abs(Math.hypot(...out) - 9.9)).toBeLessThan(0.02);
    }
  });

  test('has labels, a dark side, and an operand in a formula', async () => {
    const mask = Uint8Array.from(ball, (v) => (v > 0 ? 3 : 0));
    const label = await made.sample({ image: mask, size }, { label: 3, count: 500 });
    expect(label.params).toEqual({ smooth: 1 });
    expect(Math.abs(Math.sqrt((label.report?.quality?.area ?? 0) / (4 * Math.PI)) - 10)).toBeLessThan(0.5);
    const dark = await made.sample({ image: ball, size }, { iso: 0, darkInside: true, count: 300 });
    const out = [0, 1, 2].map((k) => dark.points[k] - Middle[k]);
    expect(out.reduce((sum, v, k) => sum + v * dark.normals[k], 0)).toBeLessThan(0);
    const half = await made.sample({ image: ball, size }, { iso: 0, formula: 'max(model, z - 15.1)', count: 500 });
    const highest = Math.max(...half.points.filter((_, k) => k % 3 === 2));
    expect(highest).toBeCloseTo(15.1, 3);
  });

  test('is closed at the border of the image', async () => {
    const rod = Float32Array.from(
      { length: 20 ** 3 },
      (_, at) => 6 - Math.hypot((at % 20) - 9.3, (((at / 20) | 0) % 20) - 9.6),
    );
    const given = { image: rod, size: /** @type {[number, number, number]} */ ([20, 20, 20]) };
    const open = await made.sample(given, { iso: 0, smooth: 0, count: 500 });
    const closed = await made.sample(given, { iso: 0, smooth: 0, closeBorder: true, count: 500 });
    const highest = (/** @type {Float32Array | Float64Array} */ points) =>
      Math.max(...points.filter((_, k) => k % 3 === 2));
    expect(highest(open.points)).toBeCloseTo(19, 2);
    // The cap is at half a voxel, to a tenth of one.
    expect(Math.abs(highest(closed.points) - 19.5)).toBeLessThan(0.1);
    await expect(made.sample('x^2 + y^2 + z^2 = 1', { closeBorder: true })).rejects.toThrow(/closeBorder/);
  });

  test('is refused with what is wrong', async () => {
    const image = ball;
    for (const [field, options, words] of /** @type {[any, any, RegExp][]} */ ([
      [{ image }, {}, /no known kind/],
      [{ image: 'scan.nii' }, {}, /a File, a Blob/],
      [{ image, size: [32, 32, 31] }, {}, /31744 values, and the array has 32768/],
      [{ image: [...image], size }, {}, /typed array/],
      [{ image, size, spacing: [1, 0, 1] }, {}, /spacing\[1\]: a length above 0/],
      [{ image, size, spacing: 1, affine: [] }, {}, /in place of spacing/],
      [{ image: new Blob([ball]), spacing: 2 }, {}, /spacing: for an array/],
      [{ image, size }, { iso: 1e6 }, /choose one between them/],
      [{ image, size }, { iso: 1, label: 1 }, /one of the two/],
      [{ image, size }, { label: 5000 }, /no voxel has the label/i],
      [{ image, size }, { smooth: -1 }, /from 0 to 100/],
      ['x', { iso: 1 }, /iso: for an image/],
    ]))
      await expect(made.sample(field, options)).rejects.toMatchObject({
        name: 'InputError',
        message: expect.stringMatching(words),
      });
  });
});

describe('a mesh', () => {
  const points = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1]);
  const squares = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ];
  const faces = squares.flatMap(([a, b, c, d]) => [
    [a, b, c],
    [a, c, d],
  ]);
  const cube = /** @type {any} */ ({ points, faces });
  const off = ['OFF', '8 6 0', ...points.map((p) => p.join(' ')), ...squares.map((f) => `4 ${f.join(' ')}`)].join('\n');

  test('of arrays is sampled anew with its edges, and what has become of it is told', async () => {
    const sample = await made.sample({ mesh: cube, name: 'cube' }, { count: 2000 });
    expect(sample.original).toMatchObject({
      name: 'cube',
      faces: 12,
      vertices: 8,
      part: { patches: 6, edges: 12, corners: 8, faded: 0 },
      scan: null,
    });
    expect(sample.change?.volume[1]).toBeCloseTo(8, 3);
    expect(sample.change?.area[1]).toBeCloseTo(24, 3);
    expect(sample.change?.to_new.largest).toBeLessThan(1e-3);
    expect(sample.change?.edges).toBeLessThan(1e-3);
    // Every particle is on a face of the cube.
    for (let i = 0; i < sample.points.length; i += 3)
      expect(Math.max(...sample.points.slice(i, i + 3).map(Math.abs))).toBeCloseTo(1, 4);
    expect((await sample.mesh()).volume).toBeCloseTo(8, 3);
  });

  test('of a file is that of its arrays, in a blob, a buffer or its bytes', async () => {
    const { digest } = await made.sample({ mesh: cube }, { count: 1000 });
    const file = new Blob([off]);
    const buffer = await file.arrayBuffer();
    for (const mesh of [file, buffer, new Uint8Array(buffer)])
      expect((await made.sample({ mesh }, { count: 1000 })).digest).toBe(digest);
  });

  test('is a scan where no edges are kept, and an operand in a formula, of which nothing is compared', async () => {
    const round = await made.sample({ mesh: cube }, { count: 1000, edges: 'none', smooth: 2 });
    expect(round.original).toMatchObject({ part: null, scan: { smooth: 2 } });
    expect(round.params).toEqual({ smooth: 2 });
    expect(round.change?.edges).toBe(null);
    const half = await made.sample({ mesh: cube }, { count: 1000, formula: 'max(model, z)' });
    expect(Math.max(...half.points.filter((_, k) => k % 3 === 2))).toBeCloseTo(0, 4);
    expect(half.change).toBe(null);
    expect((await made.sample({ mesh: cube }, { count: 500, measure: false })).change).toBe(null);
  });

  test('is refused with what is wrong', async () => {
    for (const [field, options, words] of /** @type {[any, any, RegExp][]} */ ([
      [{ mesh: 'part.stl' }, {}, /\{points, faces\}, a File/],
      [{ mesh: { points, faces: [[0, 1, 8]] } }, {}, /faces\[2\]: the index of one of 8 vertices/],
      [{ mesh: { points, faces: [0, 1] } }, {}, /three vertices for each/],
      [{ mesh: { points, faces } }, { borders: 1 }, /borders/],
      [{ mesh: { points, faces: faces.slice(2) } }, { edges: 30 }, /keep its borders or close it first/i],
      [{ mesh: new TextEncoder().encode('OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0') }, {}, /no faces, only points/i],
      [{ mesh: cube }, { edges: 0 }, /from 1 to 180 degrees/],
      [{ mesh: cube }, { smooth: 11 }, /from 0 to 10 cells/],
      [{ mesh: cube }, { edges: 30, smooth: 1 }, /not both/i],
      [{ mesh: cube }, { iso: 1 }, /iso: for an image/],
      ['x', { edges: 30 }, /edges: for a mesh/],
      ['x', { smooth: 1 }, /smooth: for an image or a mesh/],
    ]))
      await expect(made.sample(field, options)).rejects.toMatchObject({
        name: 'InputError',
        message: expect.stringMatching(words),
      });
  });
});

test('a cell of a shell is a closed solid whose opposite faces match', async () => {
  const bounds = /** @type {const} */ ({ min: [-3, -3, -3], max: [3, 3, 3] });
  const gyroid = 'sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)';
  const shell = { bounds, closed: true, thickness: '0.4 + 0.02z', count: 2000 };
  const solid = await made.sample(gyroid, /** @type {any} */ (shell));
  const { volume, components } = await solid.mesh();
  expect(volume).toBeGreaterThan(10);
  expect(components.every(({ open_edges }) => open_edges === 0)).toBe(true);
});

test('sizes are lengths or shares, and rows of points are taken', async () => {
  const [length, share] = await Promise.all(
    [0.02 * Math.sqrt(12), '2%'].map((radius) =>
      made.sample(
        SPHERE,
        /** @type {any} */ ({ radius, bounds: { min: [-1, -1, -1], max: [1, 1, 1] }, params: { a: 0.5 } }),
      ),
    ),
  );
  expect(length.count).toBe(share.count);
  const bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
  const spaced = await made.sample(SPHERE, /** @type {any} */ ({ spacing: '4%', bounds, params: { a: 0.5 } }));
  expect(spaced.digest).toBe(share.digest);
  const rows = Array.from(
    { length: ROUND.length / 3 },
    (_, i) => /** @type {[number, number, number]} */ (ROUND.slice(3 * i, 3 * i + 3)),
  );
  const [flat, nested] = await Promise.all(
    [{ points: ROUND }, { points: rows }].map((field) => made.sample(field, { count: 200 })),
  );
  expect(nested.digest).toBe(flat.digest);
  const text = rows.map((row) => row.join(' ')).join('\n');
  const files = [new Blob([text]), new TextEncoder().encode(text)];
  const read = await Promise.all(files.map((points) => made.sample({ points }, { count: 200 })));
  expect(read.map(({ digest }) => digest)).toEqual([flat.digest, flat.digest]);
  const given = made.sample(/** @type {any} */ ({ points: files[0], normals: ROUND }), { count: 200 });
  await expect(given).rejects.toThrow('normals: for arrays of points');
});

test('a program on the command line of Node', () => {
  const program = `import { sample } from 'marching-particles'; console.log((await sample('${SPHERE}', { count: 100 })).count > 50)`;
  const given = ['--input-type=module', '--eval', program];
  expect(execFileSync(process.execPath, given, { encoding: 'utf8', cwd: there.project }).trim()).toBe('true');
});

test('a program and the examples are checked by strict TypeScript', () => {
  there.write(
    'program.ts',
    `import { FormulaError, sample, type Field, type Mesh, type Options, type Sample } from 'marching-particles';
import 'marching-particles/element';
import { createView, type View } from 'marching-particles/view';
export async function ball(radius: number): Promise<Mesh> {
  const ball: Sample = await sample('${SPHERE}', { count: 500, params: { a: radius ** 2 }, method: 'refined' });
  const first: number = ball.points[0] + ball.normals[0];
  if (first > 0) await ball.moved({ a: 2 });
  return ball.mesh();
}
export const every: Required<Options> = {
  count: 500, spacing: '0.02 + 0.1 hypot(x, y)', radius: '1%', bounds: { min: [-1, -1, -1], max: [1, 1, 1] },
  beyondPoints: 'kept', formula: 'max(model, z)', params: { a: 1 }, iso: 0.5, label: 3, smooth: 1, darkInside: true,
  closeBorder: true, edges: 'auto', borders: true, adaptive: true, law: 'max_curvature', chordError: '0.1%',
  curvatureScale: 0.1, radiusMin: 0.001, radiusMax: '2%', grading: 0.2, closed: true, periodic: true,
  thickness: '0.2 + 0.1x', method: 'refined', pattern: 'blue', exactly: true, relax: 3, matchTolerance: 0.7,
  gaps: 'leave', seed: 7, maxParticles: 10_000, values: { H: '(k_1 + k_2)/2', height: (x, y, z) => z }, measure: true,
  signal: AbortSignal.timeout(1000), onProgress: ({ fraction }) => console.log(fraction),
};
export const six = ({ report, change }: Sample): (number | null | undefined)[] => [
  report?.quality?.six_neighbours, report?.places.holes[0]?.radius, change?.to_new.largest,
];
export const fields: Field[] = [
  'x^2 + y^2 + z^2 = 1',
  (x, y, z) => Math.hypot(x, y, z) - 1,
  { batch: (xyz, out) => out.forEach((_, i) => void (out[i] = xyz[3 * i])) },
  { points: new Float32Array(300) },
];
export function shown(host: HTMLElement): View {
  const element = document.createElement('marching-particles');
  element.formula = 'x^2 + y^2 = 1';
  host.append(element);
  const view = createView(host, { surface: 'gyroid', view: { draw: 'mesh' } });
  view.on('report', ({ digest }) => console.log(digest));
  return view;
}
// @ts-expect-error There is no such event.
export const none = (view: View) => view.on('end', () => {});
export const placeOf = (error: unknown): number | null => (error instanceof FormulaError ? error.start : null);
// @ts-expect-error There is no such method.
void sample('x', { method: 'best' });
`,
  );
  cpSync(new URL('../../embed/examples', import.meta.url), join(there.project, 'examples'), { recursive: true });
  const config = { strict: true, noEmit: true, module: 'nodenext', target: 'es2023', types: ['node'], checkJs: true };
  there.write('tsconfig.json', JSON.stringify({ compilerOptions: config, include: ['program.ts', 'examples/*.js'] }));
  const tsc = new URL('../../node_modules/typescript/bin/tsc', import.meta.url);
  execFileSync(process.execPath, [tsc.pathname, '-p', there.project], { stdio: 'pipe' });
});

describe('a sample', () => {
  test('has columns, figures, a mesh and files', async () => {
    const ball = await made.sample(SPHERE, { count: 1000, params: { a: 4 }, seed: 3 });
    expect(ball.report).toMatchObject({ digest: ball.digest, components: 1 });
    expect([ball.points.length, ball.normals.length]).toEqual([3 * ball.count, 3 * ball.count]);
    for (let i = 0; i < 3 * ball.count; i += 3) expect(Math.hypot(...ball.points.subarray(i, i + 3))).toBeCloseTo(2, 4);
    const mesh = await ball.mesh();
    expect(mesh.components).toMatchObject([{ triangles: 2 * ball.count - 4, euler: 2 }]);
    expect(mesh.volume).toBeCloseTo((32 / 3) * Math.PI, 0);
    expect(new TextDecoder().decode((await ball.toFile('glb')).subarray(0, 4))).toBe('glTF');
    expect(new TextDecoder().decode(await ball.toFile('obj'))).toContain('\nf ');
  });

  test('moves with its surface, and keeps its columns', async () => {
    const ball = await made.sample(SPHERE, { count: 1000, params: { a: 1 }, measure: false });
    expect(ball.report).toBe(null);
    const wider = await ball.moved({ a: 1.02 });
    expect(wider.params).toEqual({ a: 1.02 });
    expect(Math.hypot(...wider.points.subarray(0, 3))).toBeCloseTo(Math.sqrt(1.02), 4);
    expect(Math.hypot(...ball.points.subarray(0, 3))).toBeCloseTo(1, 4);
    await expect(ball.mesh()).rejects.toMatchObject({ name: 'DisposedError' });
  });

  test('that is disposed of while it is joined is joined first, and others stay', async () => {
    const options = { count: 20_000, params: { a: 1 }, measure: false };
    const [ball, other] = [await made.sample(SPHERE, options), await made.sample(SPHERE, options)];
    const jobs = [ball.mesh(), ball.toFile('stl')];
    ball.dispose();
    const [mesh, bytes] = await Promise.all(jobs);
    expect(mesh).toMatchObject({ components: [{ euler: 2 }] });
    expect(/** @type {Uint8Array} */ (bytes).length).toBeGreaterThan(84);
    expect((await other.mesh()).faces).toEqual(/** @type {import('../../package/index.js').Mesh} */ (mesh).faces);
  });

  test('that moves while it is joined is joined first', async () => {
    const ball = await made.sample(SPHERE, { count: 20_000, params: { a: 1 }, measure: false });
    const [mesh, bytes, wider] = await Promise.all([ball.mesh(), ball.toFile('stl'), ball.moved({ a: 1.2 })]);
    expect(mesh.volume).toBeCloseTo((4 / 3) * Math.PI, 2);
    expect(new DataView(bytes.buffer).getUint32(80, true)).toBe(mesh.faces.length / 3);
    expect((await wider.mesh()).volume).toBeCloseTo((4 / 3) * Math.PI * 1.2 ** 1.5, 2);
  });

  test('stays when it is to move by a wrong name', async () => {
    const ball = await made.sample(SPHERE, { count: 300, params: { a: 1 }, measure: false });
    await expect(ball.moved({ toString: 1 })).rejects.toMatchObject({
      name: 'InputError',
      message: 'params.toString: there is no such parameter. There are a.',
    });
    expect((await ball.moved({ a: 1.02 })).params).toEqual({ a: 1.02 });
  });

  test('whose particles cannot move, or are no longer to, is freed', async () => {
    // The sampler in this thread, to see what it frees.
    const { createSampler } = await import('../../package/client.js');
    const { openHere } = await import('../../package/here.js');
    const { load } = await import('../../package/load-node.js');
    const { Core } = await import('../../src/wasm/core/core.js');
    const free = vi.spyOn(Core.prototype, 'free');
    const sample = createSampler(openHere(load), openHere(load));
    const options = { count: 300, params: { a: 1 }, measure: false };

    await expect((await sample(SPHERE, options)).moved({ a: -1 })).rejects.toMatchObject({ name: 'NoSurfaceError' });
    expect(free).toHaveBeenCalledTimes(1);
    const controller = new AbortController();
    const moving = (await sample(SPHERE, options)).moved({ a: 2 }, { signal: controller.signal });
    controller.abort();
    await expect(moving).rejects.toBe(controller.signal.reason);
    await expect.poll(() => free.mock.calls.length).toBe(2);
    (await (await sample(SPHERE, options)).moved({ a: 1.02 })).dispose();
    await expect.poll(() => free.mock.calls.length).toBe(3);
    free.mockRestore();
  });

  test('tells of its progress, and beside another one is the same', async () => {
    /** @type {number[]} */
    const fractions = [];
    const options = { radius: /** @type {const} */ ('0.3%'), params: { a: 1 }, measure: false };
    const onProgress = (/** @type {{fraction: number}} */ { fraction }) => fractions.push(fraction);
    const [one, two] = await Promise.all([
      made.sample(SPHERE, { ...options, onProgress }),
      made.sample(SPHERE, options),
    ]);
    expect(one.digest).toBe(two.digest);
    expect(fractions.length).toBeGreaterThan(0);
    expect(fractions).toEqual([...fractions].sort((a, b) => a - b));
  });

  test('is an object of three.js, on the same arrays', async () => {
    const path = join(there.project, 'node_modules/marching-particles/three.js');
    const { toBufferGeometry, toInstancedMesh, toPoints } = await import(/* @vite-ignore */ pathToFileURL(path).href);
    const three = await import('three');
    const ball = await made.sample(SPHERE, { count: 300, params: { a: 1 } });
    const mesh = await ball.mesh();
    const geometry = toBufferGeometry(ball, mesh);
    expect(geometry.getAttribute('position').array).toBe(ball.points);
    expect(geometry.getIndex().array).toBe(mesh.faces);
    expect(toPoints(ball).geometry.getAttribute('normal').count).toBe(ball.count);
    const discs = toInstancedMesh(ball, new three.CircleGeometry(), new three.MeshBasicMaterial());
    const matrix = new three.Matrix4();
    discs.getMatrixAt(7, matrix);
    const [x, y, z] = matrix.elements.slice(8, 11);
    expect(Math.hypot(x, y, z)).toBeCloseTo(ball.radii[7], 6);
    expect(x / ball.radii[7]).toBeCloseTo(ball.normals[21], 4);
  });
});

describe('a function of the program', () => {
  const ball = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) => Math.hypot(x, y, z) - 1;
  const batch = {
    batch(/** @type {Float64Array} */ xyz, /** @type {Float64Array} */ out) {
      for (let i = 0; i < out.length; i += 1) out[i] = ball(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    },
  };

  test('is sampled as a formula is, one point or many at a time', async () => {
    const one = await made.sample(ball, { count: 1000 });
    const many = await made.sample(batch, { count: 1000 });
    expect(many.digest).toBe(one.digest);
    expect(Math.abs(one.count - 1000)).toBeLessThan(40);
    expect(one.report).toMatchObject({ components: 1, digest: one.digest });
    for (let i = 0; i < 3 * one.count; i += 3) expect(Math.hypot(...one.points.subarray(i, i + 3))).toBeCloseTo(1, 4);
    expect((await one.mesh()).components).toMatchObject([{ euler: 2, open_edges: 0 }]);
    expect((await one.toFile('stl')).length).toBeGreaterThan(84);
    await expect(one.moved({ a: 1 })).rejects.toMatchObject({ name: 'InputError' });
    one.dispose();
    await expect(one.mesh()).rejects.toMatchObject({ name: 'DisposedError' });
  });

  test('whose sample is disposed of while it is joined leaves the thread its core', async () => {
    const one = await made.sample(ball, { count: 20_000, measure: false });
    const joining = one.mesh();
    one.dispose();
    expect((await joining).components).toMatchObject([{ euler: 2 }]);
    expect((await made.sample(ball, { count: 100 })).count).toBeGreaterThan(50);
  });

  test('leaves its thread time for others, and a signal ends it', async () => {
    const controller = new AbortController();
    let turns = 0;
    const timer = setInterval(() => {
      turns += 1;
      if (turns === 5) controller.abort();
    }, 1);
    const long = made.sample(batch, { count: 500_000, signal: controller.signal });
    const ended = await long.catch((/** @type {unknown} */ error) => error);
    clearInterval(timer);
    expect(ended).toBe(controller.signal.reason);
    expect(turns).toBe(5);
    expect((await made.sample(batch, { count: 100 })).count).toBeGreaterThan(50);
  });

  test('may do several jobs at a time', async () => {
    const [one, two] = await Promise.all([made.sample(ball, { count: 500 }), made.sample(batch, { count: 500 })]);
    expect(one.digest).toBe(two.digest);
  });

  test('that says which piece counts has exact edges', async () => {
    /** @type {((x: number, y: number, z: number) => number)[]} */
    const pieces = [(x, y, z) => Math.hypot(x, y, z) - 1, (_x, _y, z) => z - 0.5];
    const sample = await made.sample(
      { label: (x, y, z) => pieces[1](x, y, z) > pieces[0](x, y, z), pieces },
      { count: 1000 },
    );
    expect(sample.report).toMatchObject({ creases: 1 });
    const { volume, components } = await sample.mesh();
    expect(components).toMatchObject([{ euler: 2, open_edges: 0 }]);
    // A ball of radius 1 without its cap of height 0.5.
    expect(volume).toBeCloseTo((4 * Math.PI) / 3 - (Math.PI * 0.25 * 2.5) / 3, 1);
    sample.dispose();
  });

  test('gives the spacing, and values at the particles', async () => {
    const spacing = (/** @type {number} */ _x, /** @type {number} */ _y, /** @type {number} */ z) => 0.1 + 0.05 * z;
    const values = { height: (/** @type {number} */ _x, /** @type {number} */ _y, /** @type {number} */ z) => 10 * z };
    const sample = await made.sample('x^2 + y^2 + z^2 = 1', { spacing, values: { ...values, bend: 'k_1 k_2' } });
    const { points, radii } = sample;
    const { height, bend } = sample.values;
    expect(height).toHaveLength(radii.length);
    for (let i = 0; i < radii.length; i += 1) {
      expect(2 * radii[i]).toBeCloseTo(0.1 + 0.05 * points[3 * i + 2], 3);
      expect(height[i]).toBeCloseTo(10 * points[3 * i + 2], 3);
      expect(bend[i]).toBeCloseTo(1, 2);
    }
    const header = new TextDecoder().decode((await sample.toFile('csv')).slice(0, 200)).split('\n')[0];
    expect(header.endsWith(',height,bend')).toBe(true);
    sample.dispose();
    const broken = () => {
      throw mistake;
    };
    for (const [options, words] of [
      [{ spacing: broken }, 'The function of the spacing has failed: it threw: no such place'],
      [{ values: { q: broken } }, 'The function of the value q has failed: it threw: no such place'],
    ])
      await expect(made.sample('x^2 + y^2 + z^2 = 1', /** @type {any} */ (options))).rejects.toThrow(String(words));
  });

  const mistake = new Error('no such place');
  /** @type {[string, unknown][]} */
  const wrong = [
    [
      'it threw: no such place',
      {
        batch: () => {
          throw mistake;
        },
      },
    ],
    ['returned a promise', async () => 1],
    ['returned a promise', { batch: async () => {} }],
    ['f(x, y, z) returned string', () => '1'],
    ['returned 2: it is the index of a piece, from 0 to 1', { label: () => 2, pieces: [() => 1, () => 2] }],
    ['f(x, y, z) returned undefined', () => {}],
    ['wrote 1 of', { batch: (/** @type {unknown} */ _, /** @type {Float64Array} */ out) => void out.fill(1, 0, 1) }],
  ];
  test.each(wrong)('that fails is named: %s', async (words, field) => {
    const error = await made.sample(/** @type {any} */ (field), { count: 100 }).catch((/** @type {unknown} */ e) => e);
    expect(error).toBeInstanceOf(made.FieldError);
    expect(error).toMatchObject({ name: 'FieldError', message: expect.stringContaining(words) });
    if (words.includes('threw')) expect(error).toMatchObject({ cause: mistake });
  });

  test('that fails in the middle ends its sampling alone', async () => {
    let calls = 0;
    const field = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) => {
      calls += 1;
      if (calls > 200_000) throw new TypeError('enough');
      return ball(x, y, z);
    };
    await expect(made.sample(field, { count: 100_000 })).rejects.toMatchObject({ name: 'FieldError' });
    expect(calls).toBe(200_001);
    expect((await made.sample(ball, { count: 100 })).count).toBeGreaterThan(50);
  });
});

describe('points', () => {
  const points = ROUND;

  test('have a surface through them, with their normals or without', async () => {
    for (const field of [{ points }, { points: Float32Array.from(points), normals: points }]) {
      const ball = await made.sample(field, { count: 500 });
      expect(Math.abs(ball.count - 500)).toBeLessThan(30);
      for (let i = 0; i < 3 * ball.count; i += 3)
        expect(Math.hypot(...ball.points.subarray(i, i + 3))).toBeCloseTo(1, 1);
      expect((await ball.mesh()).components).toMatchObject([{ euler: 2 }]);
    }
  });

  test('are an operand of a formula, with its parameters', async () => {
    const options = { count: 1000, formula: 'max(model, z - h)', params: { h: 0.25 } };
    const cut = await made.sample({ points, normals: points }, options);
    expect(cut.params).toEqual({ h: 0.25 });
    let top = -1;
    for (let i = 2; i < 3 * cut.count; i += 3) top = Math.max(top, cut.points[i]);
    expect(top).toBeCloseTo(0.25, 5);
    // The edge is closed.
    expect((await cut.mesh()).components).toMatchObject([{ euler: 2, open_edges: 0 }]);
    await expect(cut.moved({ h: 0 })).rejects.toMatchObject({ name: 'InputError' });
  });
});

test('programs that the command line prints make the same particles', async () => {
  /** @type {{arguments: string[], digest: string, programs: {js: string}}[]} */
  const cases = JSON.parse(readFileSync(new URL('../../../tests/golden/code.json', import.meta.url), 'utf8'));
  const printed = cases.filter(({ programs }) => programs.js.startsWith('import '));
  expect(printed.length).toBeGreaterThan(4);
  for (const [k, { arguments: given, digest, programs }] of printed.entries()) {
    const path = there.write(`printed-${k}.js`, programs.js.replace('const particles', 'export const particles'));
    const { particles } = await import(/* @vite-ignore */ pathToFileURL(path).href);
    expect(particles.digest, given.join(' ')).toBe(digest);
    particles.dispose();
  }
});

test('in one file, sampled in the thread that imports it, particles are the same', async () => {
  const path = join(there.project, 'node_modules/marching-particles/inline.js');
  const inline = await import(/* @vite-ignore */ pathToFileURL(path).href);
  expect((await inline.sample(GYROID.formula, GYROID.options)).digest).toBe(golden.digest);
  await expect(inline.sample('x^2 +')).rejects.toBeInstanceOf(inline.FormulaError);
});

test('the spacing is the distance between neighbours, in the units of the field', async () => {
  const ball = await made.sample(SPHERE, { spacing: 0.1, params: { a: 1 }, measure: false });
  expect(ball.radii[0]).toBeCloseTo(0.05, 6);
});

test('particles at a crease are joined by welding', async () => {
  const cube = await made.sample('max(abs(x), abs(y), abs(z)) = 1', { count: 1000 });
  const [apart, welded] = [await cube.mesh(), await cube.mesh({ weld: true })];
  expect(new Set(welded.faces).size).toBeLessThan(new Set(apart.faces).size);
  expect(new Set(welded.faces).size - welded.faces.length / 6).toBe(2);
});

describe('a signal', () => {
  test('ends a sampling within 50 ms, and the next one is not kept waiting', async () => {
    await made.sample(SPHERE, { count: 100, params: { a: 1 } });
    const controller = new AbortController();
    const long = made.sample(SPHERE, { count: 1_000_000, params: { a: 1 }, signal: controller.signal });
    await new Promise((resolve) => setTimeout(resolve, 200));
    const before = performance.now();
    controller.abort();
    controller.abort();
    await expect(long).rejects.toBe(controller.signal.reason);
    expect(performance.now() - before).toBeLessThan(50);
    const next = await made.sample(SPHERE, { count: 100, params: { a: 1 }, measure: false });
    expect(next.count).toBeGreaterThan(50);
    // A million take longer than that on any machine.
    expect(performance.now() - before).toBeLessThan(2000);
  });

  test('that was given before asks the worker for nothing', async () => {
    const reason = new Error('no longer wanted');
    await expect(made.sample(SPHERE, { signal: AbortSignal.abort(reason) })).rejects.toBe(reason);
  });
});

describe('what is wrong has a name and says what to do', () => {
  const box = (/** @type {number} */ least) => ({ min: [least, -1, -1], max: [1, 1, 1] });
  test.each([
    ['InputError', 'field: a formula such as', 5, {}],
    ['InputError', 'field: a formula such as', null, {}],
    ['InputError', 'field: a formula such as', {}, {}],
    ['InputError', 'points: an array of numbers', { points: [1, 2] }, {}],
    ['InputError', 'points[4]: a number, not NaN', { points: [1, 2, 3, 4, NaN, 6] }, {}],
    ['InputError', 'normals: one for each point, not 1 for 2', { points: [1, 2, 3, 4, 5, 6], normals: [0, 0, 1] }, {}],
    ['InputError', 'points lie on a straight', { points: [0, 0, 0, 1, 0, 0] }, {}],
    ['InputError', 'a function, points, an image or a mesh have none', () => 1, { params: { a: 1 } }],
    ['InputError', 'formula: for points', SPHERE, { formula: 'max(model, z)' }],
    ['InputError', 'formula: a text', { points: [1, 2, 3] }, { formula: 3 }],
    ['InputError', 'The option radius has no effect with adaptive: true', SPHERE, { radius: 0.01, adaptive: true }],
    ['InputError', 'The option spacing has no effect with adaptive: true', SPHERE, { spacing: 0.1, adaptive: true }],
    ['InputError', 'option grading has no effect without adaptive: true', SPHERE, { grading: 0.3 }],
    ['InputError', 'option periodic has no effect without closed: true', SPHERE, { periodic: true }],
    ['InputError', 'closed: for a formula by itself', () => 1, { closed: true }],
    ['InputError', 'option relax is 2000, but must lie between', SPHERE, { relax: 2000 }],
    ['InputError', 'radius: a length above 0, or a share', SPHERE, { radius: '3' }],
    ['FormulaError', 'Thickness: Something is missing', SPHERE, { thickness: '0.1 +' }],
    ['InputError', 'adaptive: true or false', SPHERE, { adaptive: 'yes' }],
    ['InputError', 'measure: true or false', SPHERE, { measure: 1 }],
    ['InputError', 'spacing: a length above 0', SPHERE, { spacing: 0 }],
    ['InputError', 'count, spacing: one of the two', SPHERE, { count: 10, spacing: 1 }],
    ['InputError', 'options: an object', SPHERE, null],
    ['InputError', 'no such option', SPHERE, { size: 3 }],
    ['InputError', 'count: a whole number', SPHERE, { count: NaN }],
    ['InputError', 'one of the two', SPHERE, { count: 100, radius: 0.01 }],
    ['InputError', 'bounds: {min', SPHERE, { bounds: box(NaN) }],
    ['InputError', 'bounds: {min', SPHERE, { bounds: box(2) }],
    ['InputError', 'params.a: a number', SPHERE, { params: { a: '1' } }],
    ['InputError', 'no parameter “b”', SPHERE, { params: { b: 1 } }],
    ['InputError', 'method: one of', SPHERE, { method: 'best' }],
    ['InputError', 'seed: a whole number', SPHERE, { seed: -1 }],
    ['InputError', 'signal: the signal', SPHERE, { signal: {} }],
    ['InputError', 'onProgress: a function', SPHERE, { onProgress: 1 }],
    ['FormulaError', 'missing', 'x^2 +', {}],
    ['FormulaError', 'as an operand of max', { points: ROUND }, { formula: 'model * x' }],
    ['FormulaError', 'missing', { points: ROUND }, { formula: 'max(model, ' }],
    ['InputError', 'no parameter “b”', { points: ROUND }, { formula: 'max(model, z)', params: { b: 1 } }],
    ['NoSurfaceError', 'no zero', 'x^2 + 1', {}],
    ['NoSurfaceError', 'f has no value anywhere', () => NaN, {}],
    ['NoSurfaceError', 'f has the same value', () => 1, {}],
    ['NoSurfaceError', 'is called with x, y and z', (/** @type {any} */ p) => p[0] - 1, {}],
    ['InputError', 'and not its name “a.glb”', { points: 'a.glb' }, {}],
  ])('%s: %s', async (name, words, field, options) => {
    const answer = made.sample(/** @type {any} */ (field), /** @type {any} */ (options));
    await expect(answer).rejects.toMatchObject({ name, message: expect.stringContaining(words) });
  });

  test('a mistake in a formula has its place and what would mend it', async () => {
    const error = await made.sample('x^2 + sqtr(y) - 1').catch((/** @type {unknown} */ error) => error);
    expect(error).toBeInstanceOf(made.FormulaError);
    expect(error).toMatchObject({ start: 6, suggestion: 'sqrt', choices: [] });
  });

  test('a sample that was disposed of', async () => {
    const ball = await made.sample(SPHERE, { count: 100, params: { a: 1 } });
    await expect(ball.toFile(/** @type {any} */ ('doc'))).rejects.toMatchObject({ name: 'InputError' });
    ball.dispose();
    ball.dispose();
    expect(ball.points.length).toBe(3 * ball.count);
    for (const late of [ball.mesh(), ball.toFile('stl'), ball.moved({ a: 2 })])
      await expect(late).rejects.toMatchObject({ name: 'DisposedError' });
  });

  test('a core that is not beside the worker, and the next sampling has it', async () => {
    const core = join(there.project, 'node_modules/marching-particles/core_bg.wasm');
    const node = pathToFileURL(join(there.project, 'node_modules/marching-particles/node.js'));
    const { sample } = await import(/* @vite-ignore */ `${node.href}?again`);
    renameSync(core, `${core}.away`);
    const failed = await sample(SPHERE).catch((/** @type {unknown} */ error) => error);
    renameSync(`${core}.away`, core);
    expect(failed).toMatchObject({ name: 'WorkerError', message: expect.stringContaining('core_bg.wasm') });
    expect((await sample(SPHERE, { count: 100, params: { a: 1 } })).count).toBeGreaterThan(50);
  });

  test('a function that is told of progress and throws ends its sampling with its error', async () => {
    const error = new Error('no more');
    const onProgress = () => {
      throw error;
    };
    await expect(made.sample(SPHERE, { count: 1_000_000, params: { a: 1 }, onProgress })).rejects.toBe(error);
  });

  test('a worker that does not start, or fails: the next sampling has another', async () => {
    // The client by itself, over a worker that does what the test wants.
    const { createSampler } = await import('../../package/client.js');
    /** @type {import('../../package/protocol.js').Heard[]} */
    const heard = [];
    let isBroken = true;
    const open = (/** @type {import('../../package/protocol.js').Heard} */ events) => {
      if (isBroken) throw new Error('blocked by the policy of the page');
      heard.push(events);
      return { post: () => {}, end: () => {}, hold: () => {} };
    };
    const sample = createSampler(open, open);
    await expect(sample(SPHERE)).rejects.toMatchObject({
      name: 'WorkerError',
      message: 'The worker did not start: blocked by the policy of the page',
    });
    isBroken = false;
    for (const fail of [
      () => heard[0].onFail('its script did not load'),
      () => heard[1].onMessage({ id: 3, error: { name: 'WorkerError', message: 'unreachable', facts: {} } }),
    ]) {
      const asked = sample(SPHERE);
      await Promise.resolve();
      fail();
      await expect(asked).rejects.toMatchObject({ name: 'WorkerError' });
    }
    expect(heard).toHaveLength(2);
  });
});
