import { describe, expect, test } from 'vitest';
import { nextBudget } from '../../../src/engine/bundle/slices.js';
import { runJob } from '../../../src/engine/sampling/job.js';
import { Jobs } from '../../../src/engine/sampling/jobs.js';
import { fakeCore } from './fake-core.js';

/** @import { FromWorker, Memory, Numbered, RelaxJob, SampleJob } from '../../../src/engine/sampling/types.js' */

/**
 * @param {Partial<SampleJob & Pick<Numbered, 'id' | 'given'>>} [part]
 * @returns {Numbered & {job: SampleJob}}
 */
const sampleJob = ({ id = 7, given = null, ...part } = {}) => ({
  id,
  job: { kind: 'grow', field: { formula: 'x' }, settings: {}, following: [], asksAbove: Infinity, ...part },
  given,
});
/** @param {number} id @param {number} steps @returns {Numbered & {job: RelaxJob}} */
const relaxJob = (id, steps) => ({ id, job: { kind: 'relax', of: 7, steps }, given: null });

/**
 * Runs a job on a scripted core, and returns what it posted.
 * @param {ReturnType<typeof fakeCore>} core
 * @param {Numbered} job
 * @param {{interrupt?: (posted: FromWorker[]) => 'stop' | 'replace' | null, room?: (posted: FromWorker[]) => boolean,
 *   curvature?: (posted: FromWorker[]) => boolean, mesh?: boolean, memory?: Memory}} [options]
 */
async function run(
  core,
  job,
  {
    interrupt = () => null,
    room = () => true,
    curvature = () => false,
    mesh = false,
    memory = { held: 0, meshed: 0, gaveUp: false },
  } = {},
) {
  /** @type {FromWorker[]} */
  const posted = [];
  await runJob(
    core,
    job,
    {
      nowMs: () => core.clock.ms,
      pause: async () => {
        core.clock.ms += 1;
      },
      post: (message) => posted.push(structuredClone(message)),
      interrupt: () => interrupt(posted),
      room: () => room(posted),
      curvature: () => curvature(posted),
      mesh: () => mesh,
    },
    memory,
  );
  return { posted, memory };
}

/**
 * @template {FromWorker['type']} T
 * @param {FromWorker[]} posted
 * @param {T} type
 * @returns {Extract<FromWorker, {type: T}>[]}
 */
const of = (posted, type) => /** @type {any} */ (posted.filter((m) => m.type === type));

/** Returns whether a message tells how far the measurement is. @param {FromWorker} message */
const isMeasuring = (message) => message.type === 'progress' && message.progress.phase === 'quality';

/**
 * Listens to the calls of a method. Returns what tells how long the longest has taken, in ms.
 * @param {ReturnType<typeof fakeCore>} core @param {'fit' | 'step' | 'measure' | 'join'} method
 */
function longestOf(core, method) {
  let longest = 0;
  const call = /** @type {(...parts: any[]) => any} */ (core[method].bind(core));
  core[method] = (/** @type {any[]} */ ...parts) => {
    const before = core.clock.ms;
    const out = call(...parts);
    longest = Math.max(longest, core.clock.ms - before);
    return out;
  };
  return () => longest;
}

describe('a job', () => {
  test('ranges join up to the core’s own columns, in order and without a gap', async () => {
    const core = fakeCore({ particles: 20_000, relax_steps: 3, usPerUnit: 5 });
    const { posted } = await run(core, sampleJob());
    const ranges = of(posted, 'columns');
    expect(ranges.length).toBeGreaterThan(4);
    const positions = new Float32Array(60_000);
    let have = 0;
    for (const range of ranges) {
      expect(range.first).toBeLessThanOrEqual(have);
      positions.set(range.positions, 3 * range.first);
      have = range.total;
    }
    expect(positions).toEqual(core.positions(0));
    const done = of(posted, 'done');
    expect(done).toHaveLength(1);
    expect(done[0].outcome).toBe('complete');
    expect(of(posted, 'report')).toHaveLength(1);
    expect(posted.at(-1)?.type).toBe('report');
  });

  test('the box is found before the sampling starts, and told', async () => {
    const core = fakeCore({ fitSlices: 500 });
    const { posted } = await run(core, sampleJob());
    const types = posted.map(({ type }) => type);
    expect(types.indexOf('box')).toBeGreaterThanOrEqual(0);
    expect(types.indexOf('box')).toBeLessThan(types.indexOf('started'));
    expect(of(posted, 'box')[0].answer.bounds.max).toEqual([2, 2, 2]);
  });

  test('a search for a box that takes long gives way to a newer job at once, and to a stop', async () => {
    for (const usPerSlice of [5, 1000]) {
      const core = fakeCore({ fitSlices: 1e6, usPerSlice });
      const longest = longestOf(core, 'fit');
      const replaced = await run(core, sampleJob(), { interrupt: () => (core.clock.ms > 300 ? 'replace' : null) });
      expect(of(replaced.posted, 'done')).toHaveLength(0);
      expect(of(replaced.posted, 'beat').length).toBeGreaterThan(0);
      const stopped = await run(core, sampleJob(), { interrupt: () => 'stop' });
      expect(of(stopped.posted, 'done')[0].outcome).toBe('stopped');
      expect(core.calls).not.toContain('start');
      expect(longest(), `at ${usPerSlice} µs a slice`).toBeLessThan(50);
    }
  });

  test('the last word on the slots covers every particle', async () => {
    const core = fakeCore({ particles: 5000, relax_steps: 0 });
    const { posted } = await run(core, sampleJob({ settings: { relax_steps: 0 } }));
    const last = of(posted, 'columns').at(-1);
    expect(last?.slotsFrom).toBe(0);
    expect(last?.slots).toHaveLength(5000);
  });

  test('time is booked on the phase that spent it', async () => {
    const core = fakeCore({ particles: 10_000, relax_steps: 2, usPerUnit: 10 });
    const { posted } = await run(core, sampleJob());
    const [report] = of(posted, 'report');
    // The first step runs on the seeding clock: until it returns, nothing else is known.
    expect(report.report.seconds.seeding + report.report.seconds.generation).toBeCloseTo(0.1, 3);
    expect(report.report.seconds.relaxation).toBeCloseTo(0.2, 3);
    expect(report.report.seconds.quality).toBeCloseTo(0.05, 3);
  });

  test('a stop keeps what there is and says so', async () => {
    const core = fakeCore({ particles: 1_000_000 });
    const { posted, memory } = await run(core, sampleJob(), {
      interrupt: (p) => (of(p, 'columns').length >= 2 ? 'stop' : null),
    });
    const [done] = of(posted, 'done');
    expect(done.outcome).toBe('stopped');
    expect(done.progress?.stop_reason).toBe('cancelled');
    const total = of(posted, 'columns').at(-1)?.total ?? 0;
    expect(total).toBeGreaterThan(0);
    expect(total).toBeLessThan(1_000_000);
    expect(total).toBe(core.count());
    expect(memory.held).toBe(7);
  });

  test('no single step outlasts a stop by more than 50 ms, on a fast machine and on a slow one', async () => {
    for (const usPerUnit of [0.05, 1, 20]) {
      const core = fakeCore({ particles: 200_000, relax_steps: 0, usPerUnit });
      const longest = longestOf(core, 'step');
      await run(core, sampleJob({ settings: { relax_steps: 0 }, kind: 'live' }));
      expect(longest(), `at ${usPerUnit} µs per unit`).toBeLessThan(50);
    }
  });

  test('a newer job takes over at once, without a report of the old one', async () => {
    const core = fakeCore({ particles: 1_000_000 });
    const { posted, memory } = await run(core, sampleJob(), {
      interrupt: (p) => (of(p, 'columns').length >= 1 ? 'replace' : null),
    });
    expect(of(posted, 'done')).toHaveLength(0);
    expect(of(posted, 'report')).toHaveLength(0);
    expect(memory.held).toBe(0);
  });

  test('a measurement ends no call later than 50 ms after it began, on a fast machine and on a slow one', async () => {
    for (const usPerSlice of [5, 50, 1000]) {
      const core = fakeCore({ slices: 5000, usPerSlice });
      const longest = longestOf(core, 'measure');
      const { posted } = await run(core, sampleJob());
      expect(of(posted, 'report')).toHaveLength(1);
      expect(longest(), `at ${usPerSlice} µs per slice`).toBeLessThan(50);
    }
  });

  test('a newer job ends a measurement, and a long one lets itself be heard', async () => {
    const core = fakeCore({ slices: 100_000, usPerSlice: 50 });
    const { posted, memory } = await run(core, sampleJob(), {
      interrupt: (p) => (p.filter(isMeasuring).length >= 3 ? 'replace' : null),
    });
    expect(of(posted, 'done')[0]).toMatchObject({ outcome: 'complete', reportFollows: true });
    const told = of(posted.filter(isMeasuring), 'progress').map(({ progress }) => progress.fraction);
    expect(told).toHaveLength(3);
    expect(told).toEqual(told.toSorted((a, b) => a - b));
    expect(told[2]).toBeLessThan(1);
    expect(of(posted, 'report')).toHaveLength(0);
    expect(memory.held).toBe(7);
  });

  test('a page that does not draw is not flooded', async () => {
    const core = fakeCore({ particles: 200_000, relax_steps: 5, usPerUnit: 5 });
    const { posted } = await run(core, sampleJob(), { room: (p) => of(p, 'columns').length < 2 });
    // Two while it runs, and the final state.
    expect(of(posted, 'columns')).toHaveLength(3);
    expect(of(posted, 'columns').at(-1)?.total).toBe(200_000);
    expect(of(posted, 'progress').length).toBeGreaterThan(2);
  });

  test('a live job posts one whole picture and no report', async () => {
    const core = fakeCore({ particles: 20_000, relax_steps: 3 });
    const { posted } = await run(core, sampleJob({ kind: 'live' }));
    expect(of(posted, 'columns')).toHaveLength(1);
    expect(of(posted, 'columns')[0]).toMatchObject({ first: 0, total: 20_000 });
    expect(of(posted, 'report')).toHaveLength(0);
    expect(of(posted, 'done')[0].reportFollows).toBe(false);
  });

  test('the particles of the run before follow if its settings are among those that may', async () => {
    const core = fakeCore({ particles: 500 });
    const memory = { held: 0, meshed: 0, gaveUp: false };
    const live = /** @type {const} */ ({ kind: 'live' });
    const following = [{ count: 500 }];
    for (const [id, count, followed] of /** @type {const} */ ([
      [1, 500, false],
      [2, 300, true],
      [3, 300, true],
    ])) {
      const { posted } = await run(core, sampleJob({ ...live, following, id, settings: { count } }), { memory });
      const done = posted.find(({ type }) => type === 'done');
      expect(done).toMatchObject({ outcome: 'complete', followed, progress: { particles: 500 } });
      const columns = posted.filter(({ type }) => type === 'columns');
      expect(columns).toHaveLength(1);
      expect(columns[0]).toMatchObject({ first: 0, total: 500 });
      expect(memory.held).toBe(id);
    }
    const other = sampleJob({ ...live, id: 4, settings: { count: 300 }, following: [{ count: 400 }] });
    const { posted } = await run(core, other, { memory });
    expect(posted.find(({ type }) => type === 'done')).toMatchObject({ followed: false, progress: { particles: 300 } });
    expect(core.calls.filter((call) => call === 'start')).toHaveLength(2);
  });

  test('that is stopped before it starts moves no particle', async () => {
    const core = fakeCore({ particles: 3000 });
    await run(core, sampleJob());
    const made = core.calls.length;
    const job = sampleJob({ id: 8, kind: 'live', following: [sampleJob().job.settings] });
    const { posted } = await run(core, job, { interrupt: () => 'stop' });
    expect(of(posted, 'done')).toMatchObject([{ id: 8, outcome: 'stopped', reportFollows: false }]);
    expect(core.calls.slice(made)).not.toContain('follow');
    expect(core.calls.slice(made)).not.toContain('start');
  });

  test('that is stopped before its particles have come to the new surface shows none of them', async () => {
    const core = fakeCore({ particles: 3000 });
    const memory = { held: 0, meshed: 0, gaveUp: false };
    await run(core, sampleJob(), { memory });
    const settings = /** @type {any} */ ({ count: 3000 });
    const job = sampleJob({ id: 8, kind: 'live', settings, following: [settings] });
    const interrupt = () => (core.calls.includes('follow') ? 'stop' : null);
    const { posted } = await run(core, job, { memory, interrupt });
    expect(core.calls).toContain('follow');
    expect(of(posted, 'columns')).toEqual([]);
    expect(of(posted, 'done')).toMatchObject([{ id: 8, outcome: 'stopped', progress: null, reportFollows: false }]);
    expect(memory.held).toBe(0);
  });

  test('a live job that is stopped is the last of its drag, and is reported', async () => {
    const { posted } = await run(fakeCore({ particles: 1_000_000 }), sampleJob({ kind: 'live' }), {
      interrupt: () => 'stop',
    });
    expect(of(posted, 'done')[0]).toMatchObject({ outcome: 'stopped', reportFollows: false });
    let calls = 0;
    const interrupt = () => {
      calls += 1;
      return calls > 5 ? 'stop' : null;
    };
    const later = await run(fakeCore({ particles: 1_000_000 }), sampleJob({ kind: 'live' }), { interrupt });
    expect(of(later.posted, 'done')[0]).toMatchObject({ outcome: 'stopped', reportFollows: true });
    expect(of(later.posted, 'report')).toHaveLength(1);
  });

  test('without growth, the picture waits until the front is complete', async () => {
    const core = fakeCore({ particles: 20_000, relax_steps: 3 });
    const { posted } = await run(core, sampleJob({ kind: 'change' }));
    for (const range of of(posted, 'columns')) expect(range.total).toBe(20_000);
  });

  test('more particles than agreed are asked about first', async () => {
    const core = fakeCore({ particles: 500_000 });
    const { posted } = await run(core, sampleJob({ asksAbove: 200_000 }));
    expect(of(posted, 'done')[0]).toMatchObject({ outcome: 'ask', predicted: 500_000 });
    expect(core.calls).not.toContain('step');
  });

  test('brings the curvature only while it is shown: once per particle as they come, and of all when they rest', async () => {
    const core = fakeCore({ particles: 20_000, relax_steps: 3, usPerUnit: 5 });
    expect((await run(core, sampleJob())).posted.some((m) => m.type === 'columns' && m.curvature.length > 0)).toBe(
      false,
    );
    core.calls.length = 0;
    const { posted } = await run(core, sampleJob(), { curvature: () => true });
    let have = 0;
    for (const range of of(posted, 'columns')) {
      expect(range.curvatureFrom).toBeLessThanOrEqual(have);
      have = Math.max(have, range.curvatureFrom + range.curvature.length / 2);
    }
    expect(have).toBe(20_000);
    const last = of(posted, 'columns')
      .filter((range) => range.curvature.length > 0)
      .at(-1);
    expect(last?.curvatureFrom).toBe(0);
    expect(last?.curvature).toEqual(core.curvature(0));
    expect(core.calls.filter((call) => call === 'curvature 0').length).toBeLessThanOrEqual(3);
  });

  test('brings the curvature at once when it is asked for during the measurement', async () => {
    const core = fakeCore({ particles: 500, slices: 6000 });
    const { posted } = await run(core, sampleJob(), { curvature: (said) => said.some(isMeasuring) });
    const after = posted.slice(posted.findIndex(isMeasuring)).filter((m) => !isMeasuring(m));
    expect(after.map((m) => m.type)).toEqual(['columns', 'report']);
    expect(after[0]).toMatchObject({ type: 'columns', first: 500, total: 500, curvatureFrom: 0, progress: null });
  });

  test('makes no mesh unless one is drawn, and then sends it with the last columns', async () => {
    const core = fakeCore({ particles: 5000, relax_steps: 2 });
    const plain = await run(core, sampleJob());
    expect(core.calls).not.toContain('join');
    expect(of(plain.posted, 'columns').every(({ mesh }) => mesh === null)).toBe(true);
    const { posted, memory } = await run(core, sampleJob(), { mesh: true });
    const ranges = of(posted, 'columns');
    expect(ranges.filter(({ mesh }) => mesh).map(({ mesh }) => mesh?.triangles)).toEqual([Uint32Array.of(0, 1, 2)]);
    expect(ranges.findIndex(({ mesh }) => mesh)).toBe(ranges.length - 1);
    expect(ranges.length).toBeGreaterThan(2);
    expect(memory).toEqual({ held: 7, meshed: 7, gaveUp: false });
    // The mesh does not wait for the figures.
    expect(
      posted
        .filter((m) => m.type !== 'progress')
        .map(({ type }) => type)
        .slice(-4),
    ).toEqual(['columns', 'past', 'done', 'report']);
  });

  test('leaves a mesh on the page until the next one is there, unless it is to be seen growing', async () => {
    for (const kind of /** @type {const} */ (['change', 'live'])) {
      const job = sampleJob({ kind });
      const { posted } = await run(fakeCore({ particles: 20_000, relax_steps: 4 }), job, { mesh: true });
      const [first, ...more] = of(posted, 'columns').filter(({ radii }) => radii.length > 0);
      expect(first).toMatchObject({ first: 0, total: 20_000 });
      expect(first.mesh).not.toBe(null);
      expect(more).toEqual([]);
    }
    const core = fakeCore({ particles: 3000, relax_steps: 1 });
    const { memory } = await run(core, sampleJob());
    const relax = relaxJob(8, 4);
    const relaxed = await run(core, relax, { mesh: true, memory });
    expect(of(relaxed.posted, 'columns').filter(({ radii }) => radii.length > 0)).toHaveLength(1);
  });

  test('that is replaced while its particles are joined sends no mesh, and holds nothing', async () => {
    const core = fakeCore({ particles: 500, slices: 100_000 });
    const { posted, memory } = await run(core, sampleJob({ kind: 'change' }), {
      mesh: true,
      interrupt: () => (core.calls.includes('join') ? 'replace' : null),
    });
    expect(posted.map(({ type }) => type)).not.toContain('done');
    expect(memory.held).toBe(0);
  });

  test('that is stopped while its particles are joined ends with them, without a mesh', async () => {
    const core = fakeCore({ particles: 500, slices: 100_000 });
    const { posted, memory } = await run(core, sampleJob({ kind: 'change' }), {
      mesh: true,
      interrupt: () => (core.calls.includes('join') ? 'stop' : null),
    });
    expect(core.calls.filter((call) => call === 'join')).toHaveLength(1);
    expect(of(posted, 'columns').map(({ total, mesh }) => [total, mesh])).toContainEqual([500, null]);
    expect(of(posted, 'columns').every(({ mesh }) => mesh === null)).toBe(true);
    expect(of(posted, 'done')[0]).toMatchObject({ outcome: 'stopped', reportFollows: true });
    // The worker does not begin it again by itself.
    expect(memory).toEqual({ held: 7, meshed: 7, gaveUp: true });
  });

  test('joins in steps that leave room for a stop', async () => {
    const core = fakeCore({ particles: 500, slices: 20_000, usPerSlice: 50 });
    const longest = longestOf(core, 'join');
    await run(core, sampleJob(), { mesh: true });
    expect(longest()).toBeLessThan(50);
  });

  test('shows the levels of a refinement as they come, and of a drag the coarse one, whole', async () => {
    const refined = await run(fakeCore({ particles: 100, refined_levels: 2 }), sampleJob({ kind: 'change' }));
    expect(of(refined.posted, 'columns').at(-1)?.total).toBe(1600);
    for (const kind of /** @type {const} */ (['sketch', 'live'])) {
      const core = fakeCore({ particles: 100, refined_levels: 2 });
      const { posted } = await run(core, sampleJob({ kind, settings: { method: 'refined' } }));
      expect(of(posted, 'columns').at(-1)?.total).toBe(kind === 'sketch' ? 100 : 1600);
      expect(of(posted, 'done')).toMatchObject([
        { outcome: 'complete', progress: { stop_reason: 'complete' }, reportFollows: false },
      ]);
    }
  });

  test('relaxing goes on from the particles at hand, and only from those', async () => {
    const core = fakeCore({ particles: 3000, relax_steps: 1 });
    const { memory } = await run(core, sampleJob());
    const again = await run(core, relaxJob(8, 4), { memory });
    expect(of(again.posted, 'done')[0].outcome).toBe('complete');
    expect(of(again.posted, 'columns').at(-1)?.progress?.relax_step).toBe(5);
    for (const range of of(again.posted, 'columns')) expect(range.first).toBe(0);
    const lost = await run(core, relaxJob(9, 1), { memory: { held: 0, meshed: 0, gaveUp: false } });
    expect(of(lost.posted, 'done')[0].outcome).toBe('lost');
  });

  test('positions before every relaxation step are kept, the first as they were placed', async () => {
    const core = fakeCore({ particles: 3000, relax_steps: 3 });
    const { posted, memory } = await run(core, sampleJob());
    const [{ positions }] = of(posted, 'past');
    // The core of the tests moves everything by a half in each step.
    expect(positions.map(([x]) => x)).toEqual([0, 0.5, 1]);
    expect(positions.every(({ length }) => length === 9000)).toBe(true);
    const relax = relaxJob(8, 2);
    const again = await run(core, relax, { memory });
    expect(of(again.posted, 'past')[0].positions.map(([x]) => x)).toEqual([1.5, 2]);
  });

  test('of many particles only the positions as placed are kept, and of a drag none', async () => {
    const many = await run(fakeCore({ particles: 20_001, relax_steps: 3, usPerUnit: 1 }), sampleJob());
    expect(of(many.posted, 'past')[0].positions).toHaveLength(1);
    const drag = await run(fakeCore({ particles: 3000, relax_steps: 3 }), sampleJob({ kind: 'live' }));
    expect(of(drag.posted, 'past')).toEqual([]);
  });

  test('a relaxation that is stopped has the positions before the steps that it made', async () => {
    const core = fakeCore({ particles: 3000, relax_steps: 5 });
    const { posted } = await run(core, sampleJob(), {
      interrupt: (soFar) => (of(soFar, 'columns').some(({ progress }) => progress?.relax_step === 2) ? 'stop' : null),
    });
    expect(of(posted, 'past')[0].positions.map(([x]) => x)).toEqual([0, 0.5]);
  });
});

/**
 * Runs jobs as the worker does.
 * @param {ReturnType<typeof fakeCore>} core
 * @param {Numbered} first
 * @param {(jobs: Jobs, posted: FromWorker[]) => void} meanwhile  between any two slices of work
 */
async function work(core, first, meanwhile = () => {}) {
  /** @type {FromWorker[]} */
  const posted = [];
  const post = (/** @type {FromWorker} */ message) => void posted.push(structuredClone(message));
  const jobs = new Jobs(post, () => core.clock.ms);
  const memory = { held: 0, meshed: 0, gaveUp: false };
  jobs.add(first);
  for (let job = jobs.take(core); job; job = jobs.take(core)) {
    await runJob(
      core,
      job,
      {
        nowMs: () => core.clock.ms,
        pause: async () => {
          core.clock.ms += 1;
          meanwhile(jobs, posted);
        },
        post,
        interrupt: () => jobs.interrupt(core),
        room: () => true,
        curvature: () => false,
        mesh: () => false,
      },
      memory,
    );
  }
  return { posted, memory };
}

describe('a job that comes while another is under way', () => {
  /**
   * Adds it once so many messages of a kind are there.
   * @param {Numbered} job
   * @param {FromWorker['type']} type
   * @param {number} n
   */
  const once = (job, type, n) => {
    let added = false;
    return (/** @type {Jobs} */ jobs, /** @type {FromWorker[]} */ posted) => {
      if (added || of(posted, type).length < n) return;
      added = true;
      jobs.add(job);
    };
  };
  const faulty = sampleJob({ id: 8, field: { formula: 'x^2+' } });

  test('with a fault in its formula lets the run come to its end, and its report, as if nothing had been asked', async () => {
    const alone = await work(fakeCore({ particles: 6000 }), sampleJob());
    const { posted, memory } = await work(fakeCore({ particles: 6000 }), sampleJob(), once(faulty, 'columns', 2));
    expect(of(posted, 'field').map(({ id, answer }) => [id, answer.ok])).toEqual([
      [7, true],
      [8, false],
    ]);
    expect(posted.filter((m) => m.type !== 'field')).toEqual(alone.posted.filter((m) => m.type !== 'field'));
    expect(memory.held).toBe(7);
  });

  test('with a fault in its formula lets the measurement come to its end', async () => {
    const core = fakeCore({ particles: 500, slices: 6000 });
    const { posted, memory } = await work(core, sampleJob(), once(faulty, 'done', 1));
    expect(isMeasuring(posted[posted.length - 2])).toBe(true);
    expect(of(posted, 'field').at(-1)).toMatchObject({ id: 8, answer: { ok: false } });
    expect(posted.at(-1)).toMatchObject({ id: 7, report: { count: 500 } });
    expect(core.calls.filter((call) => call === 'start')).toHaveLength(1);
    expect(memory.held).toBe(7);
  });

  test('takes over once its field is accepted, and its field is set once', async () => {
    const core = fakeCore({ particles: 20_000 });
    const { posted, memory } = await work(
      core,
      sampleJob(),
      once(sampleJob({ id: 8, field: { formula: 'y' } }), 'columns', 2),
    );
    expect(core.calls.filter((call) => call === 'set_field')).toHaveLength(2);
    const taken = posted.findIndex((m) => m.type === 'field' && m.id === 8);
    expect(posted.slice(taken).every((m) => !('id' in m) || m.id === 8)).toBe(true);
    expect(of(posted, 'report').map((m) => m.id)).toEqual([8]);
    expect(memory.held).toBe(8);
  });

  test('is stopped with the one before it', async () => {
    for (const job of [faulty, sampleJob({ id: 8, field: { formula: 'y' } })]) {
      let added = false;
      const { posted } = await work(fakeCore({ particles: 1_000_000 }), sampleJob(), (jobs, said) => {
        if (added || of(said, 'columns').length < 2) return;
        added = true;
        jobs.add(job);
        jobs.stop();
      });
      expect(of(posted, 'done').map(({ id, outcome }) => [id, outcome])).toEqual([[job === faulty ? 7 : 8, 'stopped']]);
    }
  });

  test('of a drag is dropped by a stop, and leaves the one before it with its own field and figures', async () => {
    let added = false;
    const core = fakeCore({ particles: 20_000 });
    const settings = sampleJob().job.settings;
    const next = sampleJob({ id: 8, kind: 'live', field: { formula: 'y' }, following: [settings] });
    const { posted, memory } = await work(core, sampleJob({ kind: 'live' }), (jobs) => {
      if (added || core.count() < 100) return;
      added = true;
      jobs.add(next);
      jobs.stop();
    });
    expect(of(posted, 'dropped')).toEqual([{ type: 'dropped', id: 8 }]);
    expect(of(posted, 'field').map(({ id }) => id)).toEqual([7]);
    expect(of(posted, 'done')).toMatchObject([{ id: 7, outcome: 'stopped', reportFollows: true }]);
    expect(of(posted, 'report').map(({ id }) => id)).toEqual([7]);
    expect(core.calls).not.toContain('follow');
    expect(memory.held).toBe(7);
  });

  test('with a fault in its formula leaves the one before it stopped', async () => {
    let added = false;
    const { posted } = await work(fakeCore({ particles: 1_000_000 }), sampleJob(), (jobs, said) => {
      if (added || of(said, 'columns').length < 2) return;
      added = true;
      jobs.stop();
      jobs.add(faulty);
    });
    expect(of(posted, 'field').at(-1)).toMatchObject({ id: 8, answer: { ok: false } });
    expect(of(posted, 'done').map(({ id, outcome }) => [id, outcome])).toEqual([[7, 'stopped']]);
  });

  test('runs, though the one before it was stopped', async () => {
    let added = false;
    const { posted } = await work(fakeCore({ particles: 20_000 }), sampleJob(), (jobs, said) => {
      if (added || of(said, 'columns').length < 2) return;
      added = true;
      jobs.stop();
      jobs.add(sampleJob({ id: 8, field: { formula: 'y' } }));
    });
    expect(of(posted, 'done').map(({ id, outcome }) => [id, outcome])).toEqual([[8, 'complete']]);
  });
});

describe('latest wins', () => {
  /** The queue of a worker at work, whose clock the test moves. */
  function queue() {
    const core = fakeCore();
    /** @type {number[]} */
    const begun = [];
    const jobs = new Jobs(
      () => {},
      () => core.clock.ms,
    );
    const begin = () => {
      const job = jobs.take(core);
      if (job) begun.push(job.id);
    };
    /** Lets time pass; the job that runs looks up at the end, as between two steps. @param {number} ms */
    const pass = (ms) => {
      core.clock.ms += ms;
      if (jobs.running && jobs.interrupt(core) === 'replace') begin();
    };
    return { jobs, begun, begin, pass, core };
  }
  const live = (/** @type {number} */ id) => sampleJob({ id, kind: 'live' });

  test('of a slider at 120 Hz every run comes to its end, and the last value is always run', () => {
    const { jobs, begun, begin, pass } = queue();
    let sinceMs = 0;
    for (let id = 1; id <= 1200; id += 1) {
      pass(8);
      jobs.add(live(id));
      // Each run takes 40 ms.
      if (!jobs.running || 8 * id - sinceMs >= 40) {
        begin();
        sinceMs = 8 * id;
      }
    }
    begin();
    expect(begun.at(-1)).toBe(1200);
    expect(begun).toEqual([...begun].sort((a, b) => a - b));
    // 10 s at one run per 40 ms, and none was replaced.
    expect(begun.length).toBeGreaterThan(230);
    expect(begun.length).toBeLessThan(250);
  });

  test('a drag replaces a full run at once', () => {
    const { jobs, begun, begin, pass } = queue();
    jobs.add(sampleJob({ id: 1 }));
    begin();
    jobs.add(live(2));
    pass(1);
    expect(begun).toEqual([1, 2]);
  });

  test('a drag waits for a live run and for that of a control at rest, but neither for long nor for figures', () => {
    for (const kind of /** @type {const} */ (['live', 'rest'])) {
      const { jobs, begun, begin, pass } = queue();
      jobs.add(sampleJob({ id: 1, kind }));
      begin();
      jobs.add(live(2));
      pass(100);
      expect(begun).toEqual([1]);
      jobs.add(live(3));
      pass(100);
      expect(begun).toEqual([1, 3]);
      // Any other run replaces it at once, and so does a live one while only figures are missing.
      jobs.add(sampleJob({ id: 4, kind }));
      begin();
      jobs.add(live(5));
      jobs.sampled();
      pass(1);
      jobs.add(sampleJob({ id: 6, kind: 'change' }));
      pass(1);
      expect(begun).toEqual([1, 3, 4, 5, 6]);
    }
  });
});

test('a formula with a fault starts nothing', async () => {
  const core = fakeCore();
  const { posted } = await work(core, sampleJob({ field: { formula: 'x^2+' } }));
  expect(posted.map((m) => m.type)).toEqual(['field']);
  expect(core.calls).toEqual(['set_field']);
});

test('a job on a model hands the core the solved system, with the clip box in force', async () => {
  const info = /** @type {any} */ ({ name: 'Bunny' });
  const bounds = {
    min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
    max: /** @type {[number, number, number]} */ ([1, 1, 1]),
  };
  const points = { field: new Uint8Array(44), info: { info, bounds } };
  const core = fakeCore();
  const own = await work(core, sampleJob({ field: { points: 'bunny' }, given: points }));
  expect(core.calls).toContain('set_points 44');
  expect(core.calls).not.toContain('set_field');
  expect(of(own.posted, 'field')[0].answer).toMatchObject({ ok: true, model: info, bounds });
  const clip = { min: bounds.min, max: /** @type {[number, number, number]} */ ([1, 1, 0]) };
  const clipped = await work(core, sampleJob({ field: { points: 'bunny', bounds: clip }, given: points }));
  expect(of(clipped.posted, 'field')[0].answer).toMatchObject({ bounds: clip });
});

test('the budget follows the machine, gently', () => {
  expect(nextBudget(1000, 6)).toBe(1000);
  expect(nextBudget(1000, 3)).toBe(2000);
  expect(nextBudget(1000, 0)).toBe(2000);
  expect(nextBudget(1000, 12)).toBe(500);
  expect(nextBudget(1000, 600)).toBe(250);
  expect(nextBudget(1, 600)).toBe(1);
});
