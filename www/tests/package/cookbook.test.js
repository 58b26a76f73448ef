/** The programs of the cookbook make the particles that its commands make. */
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { install } from './packed.js';

/** @param {string} path */
const read = (path) => readFileSync(new URL(`../../../${path}`, import.meta.url), 'utf8');
/** @type {ReturnType<typeof install>} */
let there;
beforeAll(() => {
  there = install();
}, 120_000);
afterAll(() => there.remove());

/** Points of a sphere with their normals, as the tests of the command line write them. */
function points() {
  const grid = Array.from({ length: 19 }, (_, k) => (k - 9) / 9);
  const places = grid.flatMap((u) =>
    grid.flatMap((v) =>
      [1, -1].map((side) => {
        const square = u * u + v * v;
        return [2 * u, 2 * v, side * (1 - square)].map((c) => c / (1 + square)).join(' ');
      }),
    ),
  );
  return places.map((place) => `${place} ${place}\n`).join('');
}

/** The file of an image as NumPy writes it: 300 less the square of the distance from its middle. */
function image() {
  const header = "{'descr': '<i2', 'fortran_order': False, 'shape': (32, 32, 32), }";
  const square = (/** @type {number} */ k) => (k - 16) ** 2;
  const voxels = Int16Array.from({ length: 32 ** 3 }, (_, n) =>
    [n >> 10, (n >> 5) & 31, n & 31].reduce((rest, k) => rest - square(k), 300),
  );
  const head = Buffer.from(`\x93NUMPY\x01\x00\x76\x00${header.padEnd(117)}\n`, 'latin1');
  return Buffer.concat([head, Buffer.from(voxels.buffer)]);
}

test('every program makes the particles of its task', () => {
  const [intro, ...tasks] = read('docs/cookbook.md').split('\n## ');
  const [, imports] = /```js\n(.*?)```/s.exec(intro) ?? [];
  const programs = tasks.flatMap((task) => {
    const [, program] = /```js\n(.*?)```/s.exec(task) ?? [];
    const title = JSON.stringify(task.slice(0, task.indexOf('\n')));
    return program ? [`{\n${program}\nfound[${title}] = particles.digest;\n}\n`] : [];
  });
  expect(programs.length).toBeGreaterThan(8);
  there.write('scan.xyz', points());
  there.write('scan.npy', /** @type {any} */ (image()));
  const told = ['const found = {};\n', ...programs, 'console.log(JSON.stringify(found));\n'];
  const program = there.write('cookbook.js', [imports, ...told].join(''));
  const found = JSON.parse(execFileSync(process.execPath, [program], { cwd: there.project, encoding: 'utf8' }));
  /** @type {{title: string, digest: string}[]} */
  const kept = JSON.parse(read('tests/golden/cookbook.json'));
  const wanted = kept.filter(({ title }) => title in found).map(({ title, digest }) => [title, digest]);
  expect(wanted).toHaveLength(programs.length);
  expect(found).toEqual(Object.fromEntries(wanted));
}, 120_000);
