// The first part of the core samples what it is there for without the rest; and where something else is asked of it, the rest
// joins it in the midst of the call and the particles are the same.
//
// Usage: node tests/wasm/parts.mjs, after `cargo xtask wasm core`.
import { readFile } from 'node:fs/promises';
import process from 'node:process';

const folder = new URL('../../www/src/wasm/core/', import.meta.url);
const [first, rest] = await Promise.all(
  ['core_bg.wasm', 'core_rest.wasm'].map(async (name) => new WebAssembly.Module(await readFile(new URL(name, folder)))),
);
const { surfaces, default_surface, later } = JSON.parse(await readFile(new URL('description.json', folder), 'utf8'));

/** Surfaces that take what the first part has not: sines, exponentials, powers with broken exponents. */
const BEYOND = ['gyroid', 'schwarz-p', 'schwarz-d', 'helicoid', 'metaballs', 'superellipsoid'];

let instances = 0;
/** A core of its own, and how often the rest was called for. @param {boolean} whole */
async function fresh(whole) {
  instances += 1;
  const bundle = await import(new URL(`core.js?${instances}`, folder).href);
  bundle.initSync({ module: first });
  const calls = { count: 0 };
  bundle.whenMissing(() => {
    calls.count += 1;
    return rest;
  });
  if (whole) bundle.join(rest);
  return { core: new bundle.Core(), calls };
}

/** @param {boolean} is @param {string} what */
const expect = (is, what) => {
  if (!is) throw new Error(what);
};

/** @param {string} json */
const accepted = (json) => {
  const answer = JSON.parse(json);
  expect(answer.ok === true, json);
  return answer;
};

/** @param {{ step: (budget: number) => string }} core @param {(progress: any) => boolean} until */
const step = (core, until) => {
  let progress;
  do progress = JSON.parse(core.step(977));
  while (!until(progress));
  return progress;
};

/** @param {string[]} names */
const sorted = (names) => names.toSorted().join(' ');
expect(sorted(later.surfaces) === sorted(BEYOND), `said to need the rest: ${later.surfaces}`);
const functions = 'acos asin atan atan2 cbrt cos cosh exp ln log10 sin sinh tan tanh';
expect(sorted(later.functions) === functions, `said to need the rest: ${sorted(later.functions)}`);

for (const { id } of surfaces) {
  const { core, calls } = await fresh(false);
  accepted(core.set_field(JSON.stringify({ surface: id })));
  accepted(core.start('{}'));
  const { phase, particles } = step(core, (progress) => !['seeding', 'generation'].includes(progress.phase));
  expect(phase === 'search' && particles > 100, `${id}: ${particles} particles, then ${phase}`);
  const columns = [core.positions(0).length, core.normals(0).length, core.levels(0).length, core.slots(0).length];
  expect(columns.join() === [3, 3, 1, 1].map((width) => width * particles).join(), `${id}: columns of ${columns}`);
  expect(
    calls.count === Number(BEYOND.includes(id)),
    `${id}: the rest was called for ${calls.count} times before the first fronts were complete`,
  );
  step(core, (progress) => progress.stop_reason !== null);
  let report;
  while (report === undefined) report = core.measure(1000);
  expect(calls.count === 1, `${id}: the rest was called for ${calls.count} times`);

  const { core: other } = await fresh(true);
  accepted(other.set_field(JSON.stringify({ surface: id })));
  accepted(other.start('{}'));
  step(other, (progress) => progress.stop_reason !== null);
  expect(
    core.digest() === other.digest(),
    `${id}: ${core.digest()}, where the rest was there from the start ${other.digest()}`,
  );
}
console.log(`same  ${surfaces.length} surfaces, begun without the rest of the core`);

// A run that is cancelled before the rest has come keeps what is there.
{
  const { core, calls } = await fresh(false);
  accepted(core.set_field(JSON.stringify({ surface: default_surface })));
  accepted(core.start(JSON.stringify({ radius_share: 0.005 })));
  step(core, (progress) => progress.level > 20);
  const { stop_reason, particles } = JSON.parse(core.cancel());
  expect(
    stop_reason === 'cancelled' && particles > 100 && calls.count === 0,
    `${stop_reason} with ${particles} particles, ${calls.count} calls`,
  );
}

// What needs the rest from the start gets it.
for (const [what, ask] of /** @type {[string, (core: any) => string][]} */ ([
  ['a mistake in the formula', (core) => core.set_field(JSON.stringify({ formula: 'x^2 + sqr(y) = 1' }))],
  ['the adaptive front', (core) => core.start(JSON.stringify({ sampling: 'adaptive' }))],
  [
    'a surface that the survey misses',
    (core) => core.set_field(JSON.stringify({ formula: '(x-0.013)^2 + y^2 + z^2 = 1e-6' })) && core.start('{}'),
  ],
])) {
  const { core, calls } = await fresh(false);
  const { core: other } = await fresh(true);
  expect(ask(core) === ask(other), `${what}: another answer`);
  expect(calls.count === 1, `${what}: the rest was called for ${calls.count} times`);
}
console.log('same  answers that need the rest of the core');
process.exitCode = 0;
