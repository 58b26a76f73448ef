/** Surfaces from points: built-in models and files, their links, and what can go wrong with them. */
import { describe, expect, test } from 'vitest';
import { answers, expectSurface, link, open, pause, spots, strike, until, workers } from './engine.js';
import { spherePly } from './sphere.js';

const bunny = { surface: 'bunny', settings: { radius_share: 0.02 } };
/** @param {string} name @param {string} text */
const file = (name, text) => new File([text], name);

test('the bunny is solved when it is chosen, drawn with its points, and there at once the second time', async () => {
  const p = await open();
  expect(workers.points).toBe(undefined);
  const report = await p.set({ ...bunny, view: { colour: 'plain' } });
  expect(report).toMatchObject({ stop_reason: 'complete', components: 1 });
  expect(report?.count).toBeGreaterThan(80);
  expect(p.engine.model.value).toMatchObject({
    name: expect.stringContaining('bunny'),
    points: 200,
    centres: 200,
    credit: expect.stringContaining('Stanford'),
  });
  const dotted = await spots(p);
  p.engine.setView({ points: false });
  expect(dotted.black).toBeGreaterThan((await spots(p)).black + 100);
  await p.set({ surface: 'ellipsoid' });
  expect(p.engine.model.value).toBe(null);
  expect((await p.set(bunny))?.digest).toBe(report?.digest);
  expect(workers.points).toHaveLength(1);
});

test('a model goes through a link, with its settings', async () => {
  const p = await open();
  const before = await p.set({ ...bunny, view: { colour: 'curvature', points: false } });
  expect(p.engine.notice.value).toBe(null);
  const other = await open(await p.engine.link());
  expect(other.state).toMatchObject({
    surface: 'bunny',
    formula: 'model',
    settings: bunny.settings,
    view: { colour: 'curvature', points: false },
  });
  expect(other.report()?.digest).toBe(before?.digest);
});

test('a formula typed on a model leads back to formulas', async () => {
  const p = await open();
  await p.set(bunny);
  p.engine.setFormula('x^2 + y^2 + z^2 = 0.5');
  await until(p.engine.model, (model) => model === null);
  await until(p.engine.progress, ({ phase }) => phase === 'done');
  expect(p.state).toMatchObject({ surface: 'ellipsoid', formula: 'x^2 + y^2 + z^2 = 0.5' });
});

test('settings and the clip box of a model are sampled live', async () => {
  const p = await open();
  await p.set(bunny);
  const { min, max } = p.engine.field.value?.bounds ?? { min: [0, 0, 0], max: [0, 0, 0] };
  const half = (min[2] + max[2]) / 2;
  /** @param {number} share  of the upper half that is left */
  const box = (share) => /** @type {any} */ ({ min, max: [max[0], max[1], half + (max[2] - half) * share] });
  for (let k = 0; k < 30; k += 1) {
    p.engine.setBounds(box(1 - k / 29), { live: true });
    await pause(16);
  }
  p.engine.setBounds(box(0));
  await until(p.engine.report, (report) => report);
  const { positions, count } = p.particles();
  expect(count).toBeGreaterThan(20);
  for (let i = 0; i < count; i += 1) expect(positions[3 * i + 2]).toBeLessThanOrEqual(half + 1e-4);
  expect(p.engine.lastDrag.value?.shown).toBeGreaterThan(0);
});

test('the sampler replaced in the middle of a model samples it again', async () => {
  const p = await open();
  const before = await p.set(bunny);
  strike('panic');
  await until(p.engine.notice, (notice) => notice?.id === 'panic');
  expect((await p.run())?.digest).toBe(before?.digest);
  expect(p.engine.model.value).not.toBe(null);
});

test('a stop in a run on a model keeps what there is, and nobody takes it for a hang', async () => {
  const p = await open();
  await p.set(bunny);
  // Long enough to be stopped on any machine.
  void p.set({ settings: { sampling: 'adaptive', chord_error: 5e-5, relax_steps: 100 } });
  await until(p.engine.progress, ({ phase, particles }) => phase === 'generation' && particles > 200);
  p.engine.stop();
  await until(p.engine.status, (status) => status !== 'sampling');
  expect(p.engine.result.value).toBe('partial');
  expect(p.engine.progress.value.stop_reason).toBe('cancelled');
  expect(p.particles().count).toBeGreaterThan(200);
  expect(p.debug.counts().restarts).toBe(0);
});

describe('a file', () => {
  test('of points is sampled where they are', async () => {
    const p = await open();
    const report = await p.open(file('ball.ply', spherePly(300, 1.5)));
    expect(report).toMatchObject({ stop_reason: 'complete', components: 1 });
    const { positions, count } = p.particles();
    for (let i = 0; i < count; i += 1)
      expect(Math.abs(Math.hypot(...positions.subarray(3 * i, 3 * i + 3)) / 1.5 - 1)).toBeLessThan(0.03);
    expect(p.engine.model.value).toMatchObject({ name: 'ball.ply', points: 300, normals: 'given' });
    expect(p.state.surface).toBe('file');
    await expectSurface(p);
  });

  test('is not in a link: the page says so, and opens the standard surface with the settings', async () => {
    const p = await open();
    await p.open(file('ball.ply', spherePly(200, 1)));
    const other = await open(await p.engine.link());
    expect(other.engine.notice.value).toMatchObject({ id: 'link', text: expect.stringContaining('file') });
    expect(other.state).toMatchObject({ surface: 'ellipsoid', settings: { radius_share: 0.02 } });
  });

  test('that is broken is refused with its place, and the picture stays', async () => {
    const rows = spherePly(150, 1).split('\n');
    const changed = (/** @type {number} */ at, /** @type {(row: string) => string} */ change) =>
      rows.map((row, k) => (k === at ? change(row) : row)).join('\n');
    const p = await open();
    const before = p.report()?.digest;
    for (const [name, text, line] of /** @type {[string, string, number | null][]} */ ([
      ['word.ply', changed(20, (row) => row.replace(/ \S+/, ' seven')), 21],
      ['short.ply', rows.slice(0, 60).join('\n'), null],
      ['picture.ply', '\u0089PNG\r\n\u001a\n nothing of use', null],
      ['empty.ply', '', null],
    ])) {
      await p.open(file(name, text));
      expect(p.engine.loading.value).toBe(null);
      expect(p.engine.model.value).toBe(null);
      const error = p.engine.loadingError.value;
      expect(error).toMatchObject({ id: 'file', name });
      expect(error?.message.length).toBeGreaterThan(10);
      if (line !== null) expect(error?.message, name).toMatch(`line ${line}:`);
      expect(p.report()?.digest).toBe(before);
      expect(p.state.surface).toBe('ellipsoid');
      await expectSurface(p);
    }
  });

  test('of two gigabytes is not even read', async () => {
    const p = await open();
    await p.open(Object.defineProperty(file('huge.ply', 'x'), 'size', { value: 2e9 }));
    expect(p.engine.loadingError.value).toMatchObject({ kind: 'too_large', name: 'huge.ply' });
    expect(workers.points).toBe(undefined);
  });

  test('can be given up while it is read', async () => {
    const p = await open();
    const before = p.report()?.digest;
    void p.engine.openFile(file('large.ply', spherePly(60_000, 1)));
    await pause(20);
    expect(p.engine.loading.value).toMatchObject({ id: 'file', name: 'large.ply' });
    p.engine.cancelLoading();
    await until(p.engine.loading, (loading) => loading === null);
    expect(p.engine.notice.value).toBe(null);
    expect(p.report()?.digest).toBe(before);
  });
});

test('a solver that does not load is named, and the surface stays; without any surface the standard one comes', async () => {
  answers.set('points_bg', { status: 404 });
  const p = await open();
  p.engine.setSurface('bunny');
  const error = await until(p.engine.loadingError, (now) => now);
  await until(p.engine.status, (status) => status !== 'sampling');
  expect(error).toMatchObject({ kind: 'bundle', message: expect.stringContaining('404') });
  expect(p.state.surface).toBe('ellipsoid');
  await expectSurface(p);
  const other = await open(link(bunny));
  expect(other.state.surface).toBe('ellipsoid');
  expect(other.engine.loadingError.value).toMatchObject({ id: 'bunny', kind: 'bundle' });
  await expectSurface(other);
});
