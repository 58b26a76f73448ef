/** Stops at many moments of runs: what is on the page afterwards, and that nothing goes on. */
import { expect, test } from 'vitest';
import { eventually, link, open, pause, turn, workers } from './engine.js';

/**
 * @import { Vec3 } from '../../src/engine/types.js'
 * @import { Console } from '../../src/main/types.js'
 */

/** f and ∇f of the formulas. @type {Record<string, (a: number, p: number[]) => [number, Vec3]>} */
const FIELDS = {
  'x^2 + y^2 + z^2 = a': (a, [x, y, z]) => [x * x + y * y + z * z - a, [2 * x, 2 * y, 2 * z]],
  'x^2 + 2y^2 + 3z^2 = a': (a, [x, y, z]) => [x * x + 2 * y * y + 3 * z * z - a, [2 * x, 4 * y, 6 * z]],
  'x^4 + y^4 + z^4 = a': (a, [x, y, z]) => [x ** 4 + y ** 4 + z ** 4 - a, [4 * x ** 3, 4 * y ** 3, 4 * z ** 3]],
};
const FORMULAS = Object.keys(FIELDS);
/** Largest |f|/|∇f| of a particle on its surface; those of two values of a are farther apart. */
const ON_SURFACE = 1e-4;

/**
 * Whether all particles lie on the surface of a formula.
 * @param {Console} p @param {string} formula @param {number} a
 */
function lieOn(p, formula, a) {
  const { positions, count } = p.particles();
  for (let i = 0; i < count; i += 1) {
    const [f, gradient] = FIELDS[formula](a, [...positions.subarray(3 * i, 3 * i + 3)]);
    if (Math.abs(f) > ON_SURFACE * Math.hypot(...gradient)) return false;
  }
  return true;
}

/** The next number of a sequence that is the same in every test: below `n`. */
function createRandom(seed = 1) {
  let state = seed;
  return (/** @type {number} */ n) => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 2 ** 32) * n);
  };
}

test('a stop at any moment leaves one surface, and what is said of it, and starts nothing', async () => {
  const random = createRandom();
  let [formula, a] = [FORMULAS[0], 1];
  const settings = { radius_share: 0.008, relax_steps: 10 };
  const p = await open(link({ formula, declared: [], parameters: { a }, settings }));
  const { engine } = p;
  const [sampler] = workers.sampler;
  /** Kinds of the jobs that were sent. @type {string[]} */
  const jobs = [];
  const post = sampler.postMessage.bind(sampler);
  sampler.postMessage = (message, transfer) => {
    if (message.type === 'job') jobs.push(message.job.kind);
    post(message, transfer);
  };
  /** What a person may do. */
  const acts = {
    formula() {
      formula = FORMULAS[random(FORMULAS.length)];
      engine.setFormula(formula);
    },
    parameter() {
      a = 1 + random(20) / 40;
      engine.setParameter('a', a);
    },
    drag() {
      a += 0.01;
      engine.setParameter('a', a, { live: true });
    },
    run: () => engine.run(),
    setting: () => engine.setSetting('relax_steps', 5 + random(20)),
  };
  const names = /** @type {(keyof typeof acts)[]} */ (Object.keys(acts));
  const surfaces = [[formula, a]];
  /** What the stops have met, by what is on the page after them. */
  const met = { whole: 0, partial: 0, before: 0 };

  for (let trial = 0; trial < 24; trial += 1) {
    const done = [];
    for (let n = 1 + random(3); n > 0; n -= 1) {
      const name = names[random(names.length)];
      acts[name]();
      surfaces.push([formula, a]);
      // What comes next, or the stop, may come at once, within a step, while the front grows, or later.
      const ms = random(3) && 2 ** random(9);
      done.push(`${name}, ${ms} ms`);
      if (ms > 0) await pause(ms);
    }
    // The first stop comes when all is done, on a slow machine, too.
    if (trial === 0) await eventually(() => p.status()).toMatchObject({ busy: false });
    const what = `${trial}: ${done.join('; ')}`;
    const sent = jobs.length;
    await p.stop();
    const after = p.status();
    // Longer than a control is waited for that pauses.
    await turn(300);
    await pause(30);
    expect(jobs.slice(sent), what).toEqual([]);
    expect(p.status(), what).toEqual(after);
    expect(after, what).toMatchObject({ busy: false, progress: { phase: 'done' } });

    const { count } = p.particles();
    expect(count, what).toBeGreaterThan(0);
    const own = surfaces.filter(([f, value]) => lieOn(p, String(f), Number(value)));
    expect(new Set(own.map(String)).size, what).toBe(1);
    const isPresent = String(own[0]) === String([formula, a]);
    expect(p.debug.counts().dimmed, what).toBe(!isPresent);
    const { record } = engine.columns;
    if (record) expect([record.formula, record.parameters.a], what).toEqual(own[0]);
    const report = p.report();
    if (report) expect(report.count, what).toBe(count);
    if (report && record) expect(report.digest, what).toBe(record.digest);
    met[!isPresent ? 'before' : engine.result.value === 'partial' ? 'partial' : 'whole'] += 1;
  }
  // The moments are of every kind.
  expect(Math.min(...Object.values(met)), JSON.stringify(met)).toBeGreaterThan(0);
});
