// Holds the core as WebAssembly to the digests that the native core is held to by tests/it/parity.rs and mesh_parity.rs, and to
// an answer in words where the memory is used up.
//
// Usage: node tests/wasm/parity.mjs, after `cargo xtask wasm core points`.
import process from 'node:process';
import { accepted, digestOf, golden, load } from './bundles.mjs';

const { Core, memory } = await load('core');
const { Points } = await load('points');

/** Units of work per step: not the native test's number, which must make no difference. */
const BUDGET = 977;

/** @param {Core} core @param {string} model @param {object} request @param {string} name */
function solve(core, model, request, name) {
  const points = new Points();
  accepted(points.model(model), name);
  for (let done = false; !done; { done } = points.step(BUDGET));
  accepted(core.set_points(points.field(), points.info(), request), `${name}: set_points`);
  points.free();
}

/**
 * @param {{
 *   name: string, field?: object, model?: string, pulls?: object[], settings: object, moves?: Record<string, number>[],
 * }} run
 */
function sample({ name, field, model, pulls, settings, moves = [] }) {
  const core = new Core();
  if (field) accepted(core.set_field(field), `${name}: set_field`);
  if (model) solve(core, model, pulls ? { pulls } : {}, name);
  accepted(core.start(settings), `${name}: start`);
  let progress;
  do progress = core.step(BUDGET);
  while (progress.stop_reason === null);
  for (const parameters of moves) {
    accepted(core.set_field({ parameters }), `${name}: set_field`);
    while (core.fit(settings, true, BUDGET) === undefined);
    if (!core.follow(settings, false))
      throw new Error(`${name}: the particles cannot follow to ${JSON.stringify(parameters)}`);
    do progress = core.step(BUDGET);
    while (progress.stop_reason === null);
  }
  const result = { count: progress.particles, digest: core.digest() };
  core.free();
  return result;
}

const { runs, models, moved } = await golden('digests.json');
if (runs.length < 3 || models.length < 2 || moved.length < 2)
  throw new Error(`only ${runs.length}, ${models.length} and ${moved.length} runs`);
let failures = 0;
for (const run of [...runs, ...models, ...moved]) {
  const { count, digest } = sample(run);
  const same = count === run.count && digest === run.digest;
  failures += same ? 0 : 1;
  console.log(
    `${same ? 'same' : 'DIFFERENT'}  ${run.name}: ${count} particles ${digest}${same ? '' : `, natively ${run.count} ${run.digest}`}`,
  );
}

const { runs: meshed } = await golden('meshes.json');
for (const { name, field, settings, files } of meshed) {
  const core = new Core();
  accepted(core.set_field(field), `${name}: set_field`);
  accepted(core.start(settings), `${name}: start`);
  while (core.step(BUDGET).stop_reason === null);
  while (core.measure('front_too', BUDGET) === undefined);
  while (core.join(BUDGET) === undefined);
  for (const [extension, expected] of Object.entries(files)) {
    const request = { format: extension, plain: true };
    let file = core.mesh_file(request, BUDGET);
    while (file === undefined) file = core.mesh_file(request, BUDGET);
    const found = digestOf(file);
    failures += found === expected ? 0 : 1;
    console.log(`${found === expected ? 'same' : 'DIFFERENT'}  mesh of ${name} as ${extension}: ${found}`);
  }
  core.free();
}

// With no memory left, a run that needs more is refused in words, and the instance goes on working.
const core = new Core();
const enough = { radius_share: 0.02, relax_steps: 2 };
accepted(core.start(enough), 'a run before the memory is used up');
while (core.step(BUDGET).stop_reason === null);
const digest = core.digest();
for (let pages = 32_768; pages >= 1; pages = Math.floor(pages / 2)) {
  try {
    for (;;) memory.grow(pages);
  } catch {
    // No piece of this size is left: half of it may be.
  }
}
const answer = core.start({ size_mode: 'count', count: 3_000_000, max_particles: 4_000_000 });
if (answer.ok || !/not enough memory/.test(answer.error.message))
  throw new Error(`without memory: ${JSON.stringify(answer)}`);
accepted(core.start(enough), 'a run after one that was refused');
while (core.step(BUDGET).stop_reason === null);
if (core.digest() !== digest) throw new Error('a run after one that was refused has other particles');
console.log('same  without memory a run is refused, and the next works');
process.exitCode = failures > 0 ? 1 : 0;
