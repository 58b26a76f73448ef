// Holds the bundle for models from points to the digests that the native code is held to by tests/it/pointcloud_job.rs, and checks that
// the core samples what it solves.
//
// Usage: node tests/wasm/points.mjs, after `cargo xtask wasm core points`.
import process from 'node:process';
import { accepted, digestOf, golden, load } from './bundles.mjs';

const { Core } = await load('core');
const { Points } = await load('points');

/** Pieces of work per step: not the native test's number, which must make no difference. */
const BUDGET = 37;

/** @param {boolean} holds @param {string} claim */
function claim(holds, claim) {
  if (!holds) throw new Error(claim);
}

/** The text that `ellipsoid` of tests/it/pointcloud_job.rs makes. @param {number} steps @param {boolean} normals */
function ellipsoid(steps, normals) {
  const lines = [];
  // Rust writes no exponents, and the sign of a negative zero.
  const word = (/** @type {number} */ x) => (Object.is(x, -0) ? '-0' : String(x));
  for (let i = -steps; i <= steps; i += 1) {
    for (let j = -steps; j <= steps; j += 1) {
      for (let k = -steps; k <= steps; k += 1) {
        if (Math.max(Math.abs(i), Math.abs(j), Math.abs(k)) !== steps) continue;
        const length = Math.sqrt(i * i + j * j + k * k);
        const [x, y, z] = [i / length, (j / length) * 0.7, (k / length) * 0.5];
        const numbers = [x, y, z];
        if (normals) {
          const [nx, ny, nz] = [x, y / 0.49, z / 0.25];
          const size = Math.sqrt(nx * nx + ny * ny + nz * nz);
          numbers.push(nx / size, ny / size, nz / size);
        }
        lines.push(numbers.map(word).join(' '));
      }
    }
  }
  return new TextEncoder().encode(`${lines.join('\n')}\n`);
}

/** Steps to the end. @param {Points} points @param {string} name */
function finish(points, name) {
  let before = 0;
  for (;;) {
    const progress = accepted(points.step(BUDGET), name);
    claim(progress.fraction >= before && progress.fraction <= 1, `${name}: ${progress.fraction} after ${before}`);
    before = progress.fraction;
    if (progress.done) return accepted(points.info(), name);
  }
}

/** Samples a solved field in the core. @param {Points} points @param {object} known @param {string} name */
function sampled(points, known, name) {
  const core = new Core();
  accepted(core.set_points(points.field(), known, {}), `${name}: set_points`);
  accepted(core.start({ radius_share: 0.02, relax_steps: 2 }), `${name}: start`);
  while (core.step(1000).stop_reason === null);
  const count = core.count();
  core.free();
  return count;
}

const { runs } = await golden('points.json');
claim(runs.length >= 3, `only ${runs.length} runs`);
let failures = 0;
const points = new Points();
for (const { name, model, steps, normals, centres, digest: expected } of runs) {
  accepted(model === null ? points.file('points.xyz', ellipsoid(steps, normals), centres) : points.model(model), name);
  claim(points.field().length === 0 && points.info().ok === false, `${name}: a field before there is one`);
  const { ok: _, ...known } = finish(points, name);
  const found = digestOf(points.field());
  const same = found === expected;
  failures += same ? 0 : 1;
  claim(points.centres().length === 3 * centres, `${name}: ${points.centres().length} numbers for ${centres} centres`);
  const count = sampled(points, known, name);
  claim(count > 300, `${name}: ${count} particles`);
  console.log(
    `${same ? 'same' : 'DIFFERENT'}  ${name}: ${found}${same ? '' : `, natively ${expected}`}, ${count} particles`,
  );
}

// A small mesh without normals, binary, and its mistakes.
const header = `ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z
element face 4\nproperty list uchar int vertex_indices\nend_header\n`;
const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const faces = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
const ply = new Uint8Array(header.length + 4 * corners.length + 13 * 4);
ply.set(new TextEncoder().encode(header));
const view = new DataView(ply.buffer);
for (const [k, x] of corners.entries()) view.setFloat32(header.length + 4 * k, x);
for (let face = 0; face < 4; face += 1) {
  const at = header.length + 4 * corners.length + 13 * face;
  view.setUint8(at, 3);
  for (let k = 0; k < 3; k += 1) view.setInt32(at + 1 + 4 * k, faces[3 * face + k]);
}
accepted(points.file('tetrahedron.ply', ply, 0), 'a tetrahedron');
const { ok: _, ...known } = finish(points, 'a tetrahedron');
// Its four faces are large, so that they are given points.
claim(known.info.normals === 'from_mesh' && known.info.centres > 4, JSON.stringify(known));
claim(sampled(points, known, 'a tetrahedron') > 100, 'a tetrahedron has too few particles');
console.log('same  a binary mesh is read, solved and sampled');

/** @param {any} answer @param {RegExp} words */
function refused({ ok, error }, words) {
  claim(ok === false && words.test(error), JSON.stringify(error));
}
const text = (/** @type {string} */ words) => new TextEncoder().encode(words);
refused(new Points().step(1), /no model and no file/);
refused(points.model('teapot'), /known are bunny/);
refused(points.file('a.xyz', new Uint8Array(0), 0), /the file is empty/);
refused(points.file('a.xyz', text('1 2 3\n'), 20), /choose 100 to 800/);
accepted(points.file('a.ply', ply.slice(0, header.length + 4), 0), 'a file that is cut off');
refused(points.step(1), /promises 4 vertex rows/);
accepted(points.file('a.xyz', text('1 2 3\n4 five 6\n'), 0), 'a file with a mistake in its second line');
refused(points.step(1000), /^line 2: y is `five`/);
refused(points.step(1), /^line 2/);
console.log('same  mistakes are refused in words');
process.exitCode = failures > 0 ? 1 : 0;
