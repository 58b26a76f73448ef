// Holds the core as WebAssembly to the digests that the native core is held to by tests/parity.rs.
//
// Usage: node tests/wasm/parity.mjs, after `cargo xtask wasm core`.
import { readFile } from 'node:fs/promises';
import process from 'node:process';

const root = new URL('../../', import.meta.url);
const bundle = new URL('www/src/wasm/core/', root);
const { initSync, Core } = await import(new URL('core.js', bundle).href);
initSync({ module: await readFile(new URL('core_bg.wasm', bundle)) });

/** Units of work per step: not the native test's number, which must make no difference. */
const BUDGET = 977;

/** @param {string} json the core's answer @param {string} name what it answers */
function accepted(json, name) {
  const answer = JSON.parse(json);
  if (answer.ok !== true) throw new Error(`${name}: ${json}`);
}

/** @param {{ name: string, field: object, settings: object }} run */
function sample({ name, field, settings }) {
  const core = new Core();
  accepted(core.set_field(JSON.stringify(field)), `${name}: set_field`);
  accepted(core.start(JSON.stringify(settings)), `${name}: start`);
  while (JSON.parse(core.step(BUDGET)).stop_reason === null);
  const result = { count: core.count(), digest: core.digest() };
  core.free();
  return result;
}

const { runs } = JSON.parse(await readFile(new URL('tests/golden/digests.json', root), 'utf8'));
if (runs.length < 3) throw new Error(`only ${runs.length} runs`);
let failures = 0;
for (const run of runs) {
  const { count, digest } = sample(run);
  const same = count === run.count && digest === run.digest;
  failures += same ? 0 : 1;
  console.log(`${same ? 'same' : 'DIFFERENT'}  ${run.name}: ${count} particles ${digest}${same ? '' : `, natively ${run.count} ${run.digest}`}`);
}
process.exitCode = failures > 0 ? 1 : 0;
