import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { description } from './description.js';
import {
  begin,
  columnsMessage,
  done,
  page,
  progress,
  reportMessage,
  request,
  solved,
  told,
  workers,
} from './sampler-page.js';

beforeEach(begin);
afterEach(() => vi.useRealTimers());

describe('a model from points', () => {
  const bunny = /** @type {any} */ ({
    field: Uint8Array.of(1),
    info: { info: { name: 'Bunny' }, bounds: description.surfaces[0].bounds },
    centres: new Float32Array(3),
  });
  const answer = {
    ok: true,
    model: { name: 'Bunny' },
    surface: null,
    formula: '',
    parameters: [],
    auto: [],
    bounds: description.surfaces[0].bounds,
    mathml: null,
  };

  test('goes to the worker with every job, so that a new worker has it too', () => {
    const { sampler, store, say, jobs } = page();
    solved.bunny = bunny;
    sampler.sample({ ...request(''), field: { points: 'bunny', surface: 'bunny' } });
    expect(jobs()[0].given).toBe(bunny);
    say({ type: 'field', id: 1, answer });
    expect(store.field.value).toMatchObject({ model: { name: 'Bunny' }, surface: 'bunny' });
    expect(store.model.value).toMatchObject({ name: 'Bunny' });
    say({ type: 'crashed', id: 1, message: 'unreachable', stack: '' });
    say({ type: 'ready', description });
    expect(jobs()[0].given).toBe(bunny);
    sampler.sample(request('x'));
    say({ type: 'field', id: 3, answer: { ...answer, model: null } });
    expect(store.model.value).toBe(null);
  });
});

test('the curvature is asked for while it is shown, of a new worker again', () => {
  const { sampler, say } = page();
  const askedFor = () =>
    workers
      .at(-1)
      .posted.filter((/** @type {any} */ m) => m.type === 'curvature')
      .map((/** @type {any} */ m) => m.on);
  sampler.client.wish('curvature', false);
  sampler.client.wish('curvature', true);
  sampler.client.wish('curvature', true);
  expect(askedFor()).toEqual([true]);
  sampler.sample(request('x'));
  say({ type: 'crashed', id: 1, message: 'unreachable', stack: '' });
  say({ type: 'ready', description });
  expect(askedFor()).toEqual([true]);
  sampler.client.wish('curvature', false);
  expect(askedFor()).toEqual([true, false]);
});

test('the mesh is asked for while it is drawn, of a new worker again, and shown until the particles change', () => {
  const { sampler, store, columns, say, start } = page();
  sampler.client.wish('mesh', true);
  sampler.client.wish('mesh', true);
  start(1);
  const about = { triangles: 1, components: [{ triangles: 1, euler: 1, open_edges: 3 }], unfilled: 0, left_out: 0 };
  const mesh = { triangles: Uint32Array.of(0, 1, 2), about };
  say({ ...columnsMessage(1, 3), mesh });
  expect([columns.mesh, store.mesh.value]).toEqual([mesh, about]);
  expect(told.slice(-2)).toEqual(['mesh', 'changed 0..3']);
  say(columnsMessage(1, 3));
  expect([columns.mesh, store.mesh.value]).toEqual([null, null]);
  const askedFor = () => workers.at(-1).posted.filter((/** @type {any} */ m) => m.type === 'mesh').length;
  expect(askedFor()).toBe(1);
  say({ type: 'crashed', id: 1, message: 'unreachable', stack: '' });
  say({ type: 'ready', description });
  expect(askedFor()).toBe(1);
});

test('a mesh is exported by the worker that holds it, and not by a new one', async () => {
  const { sampler, say } = page();
  const [glb, stl] = ['glb', 'stl'].map((format) => sampler.client.meshFile({ format }));
  const [first, second] = workers.at(-1).posted.slice(-2);
  expect([first.file.format, second.file.format]).toEqual(['glb', 'stl']);
  say({ type: 'file', request: second.request, bytes: Uint8Array.of(2) });
  say({ type: 'file', request: first.request, bytes: null });
  await expect(glb).rejects.toThrow();
  expect(await stl).toEqual(Uint8Array.of(2));
  const lost = sampler.client.meshFile({ format: 'obj' });
  say({ type: 'crashed', id: 0, message: 'unreachable', stack: '' });
  await expect(lost).rejects.toThrow();
});

describe('a run', () => {
  test('goes from the wish to the figures', () => {
    const { sampler, store, columns, say, accept, jobs } = page();
    sampler.sample(request('x', { kind: 'new' }));
    expect(store.status.value).toBe('sampling');
    expect(jobs()).toHaveLength(1);
    accept(1);
    say(columnsMessage(1, 5));
    expect(columns.count).toBe(5);
    expect(workers[0].posted.at(-1)).toEqual({ type: 'drawn', id: 1 });
    say(done(1, 'complete', 5, { reportFollows: true }));
    expect(store.status.value).not.toBe('sampling');
    expect(store.progress.value.phase).toBe('quality');
    expect(store.report.value).toBe(null);
    say(reportMessage(1, 5));
    expect(store.report.value?.count).toBe(5);
    expect(store.progress.value.phase).toBe('done');
    expect(columns.valence).toHaveLength(5);
    expect(told).toEqual(['ready', 'grow in view', 'clear', 'changed 0..5', 'fit']);
  });

  test('asked for twice is made once', () => {
    const { sampler, jobs } = page();
    sampler.sample(request('x'));
    sampler.sample(request('x'));
    expect(jobs()).toHaveLength(1);
    sampler.sample(request('y'));
    expect(jobs()).toHaveLength(2);
  });

  test('asked for again right after its stop is made anew', () => {
    const { sampler, jobs } = page();
    sampler.sample(request('x'));
    sampler.stop();
    sampler.sample(request('x'));
    sampler.sample(request('x'));
    expect(jobs()).toHaveLength(2);
  });

  test('that was overtaken is not listened to any more', () => {
    const { sampler, store, columns, start, finish } = page();
    start(1);
    start(2, 'y');
    finish(1, 7);
    expect(columns.count).toBe(0);
    expect(store.field.value?.formula).toBe('y');
    expect(store.status.value).toBe('sampling');
    expect(sampler.stale).toBe(2);
  });

  test('that was stopped keeps its particles and is labelled', () => {
    const { sampler, store, columns, say, start, finish } = page();
    start(1);
    say(columnsMessage(1, 7));
    sampler.stop();
    expect(workers[0].posted.at(-1)).toEqual({ type: 'stop' });
    say(done(1, 'stopped', 7));
    expect(columns.count).toBe(7);
    expect(store.result.value).toBe('partial');
    start(2);
    finish(2, 9);
    expect(store.result.value).not.toBe('partial');
  });

  test('without a surface keeps the last one, dimmed and of no account, until there is another', () => {
    const { sampler, store, columns, say, start, finish } = page();
    start(1);
    finish(1, 7);
    start(2, 'y');
    // The worker sends what fates there are, also of no particle.
    say(columnsMessage(2, 0));
    say({ ...done(2, 'complete', 0), progress: progress(0, { phase: 'done', stop_reason: 'no_surface' }) });
    expect(columns).toMatchObject({ count: 7, stale: true });
    expect(store.result.value).toBe('none');
    expect(told.at(-1)).toBe('dim');
    // A mistake after that, and an empty editor, change nothing of it.
    for (const [id, kind] of /** @type {const} */ ([
      [3, 'syntax'],
      [4, 'empty'],
    ])) {
      sampler.sample(request(''));
      say({
        type: 'field',
        id,
        answer: {
          ok: false,
          error: { kind, message: '', start: 0, end: 0, suggestion: null, mended: null, name: null },
        },
      });
      expect(told.at(-1)).toBe('dim');
    }
    expect(columns.stale).toBe(true);
    expect(store.result.value).toBe('none');
    start(5);
    expect(told.at(-1)).toBe('dim');
    // Whether that one has a surface is not known until its first particle, or its end.
    expect(store.result.value).not.toBe('none');
    say(columnsMessage(5, 5));
    expect(store.result.value).not.toBe('none');
    expect(told).toContain('clear');
    say(done(5, 'complete', 5));
    expect(columns).toMatchObject({ count: 5, stale: false });
    expect(told.slice(told.lastIndexOf('dim'))).toContain('clear');
  });

  test('of a drag says that there is no surface until it counts particles, so that the words do not flicker', () => {
    const { sampler, store, say, accept, start } = page();
    start(1);
    say(done(1, 'complete', 0));
    sampler.sample(request('y', { kind: 'live' }));
    accept(2, 'y');
    expect(store.result.value).toBe('none');
    say({ type: 'progress', id: 2, progress: progress(0, { phase: 'seeding' }) });
    expect(store.result.value).toBe('none');
    say({ type: 'progress', id: 2, progress: progress(40) });
    expect(store.result.value).not.toBe('none');
  });

  test('that is stopped before its first particle counts none of the last surface where that is of no account', () => {
    const { store, columns, say, start, finish } = page();
    start(1);
    finish(1, 7);
    start(2, 'y');
    say(done(2, 'complete', 0));
    start(3, 'z');
    say(done(3, 'stopped', 0));
    expect(columns).toMatchObject({ count: 7, stale: true });
    expect([store.result.value === 'none', store.progress.value.particles]).toEqual([false, 0]);
  });

  test('counts up with every range of columns that may change what is shown of the particles', () => {
    const { store, say, start } = page();
    const seen = [store.revision.value];
    start(1);
    for (const message of [columnsMessage(1, 7), done(1, 'complete', 7)]) {
      say(message);
      seen.push(store.revision.value);
    }
    expect(seen).toEqual([...new Set(seen)]);
  });

  test('that needs more particles than agreed is asked about, once', () => {
    const { sampler, store, say, accept, jobs } = page();
    sampler.sample(request('x'));
    accept(1);
    say(done(1, 'ask', 0, { predicted: 50_000 }));
    expect(store.notice.value?.text).toBe('About 50,000 particles would be needed; the limit is 1,000.');
    store.notice.value?.action?.run();
    expect(store.notice.value).toBe(null);
    expect(jobs()[1]).toMatchObject({ kind: 'agreed', field: { formula: 'whole' } });
  });
});

test('a job that a stop drops leaves the figures that are being measured on their way', () => {
  const { sampler, store, say, accept } = page();
  sampler.sample(request('x'));
  accept(1);
  say(columnsMessage(1, 7));
  say({ ...done(1, 'complete', 7), reportFollows: true });
  sampler.sampleLive(request('y'), 3);
  sampler.stop();
  say({ type: 'dropped', id: 2 });
  expect([store.status.value, store.progress.value.phase]).toEqual(['measuring', 'quality']);
  say(reportMessage(1, 7));
  expect([store.status.value, store.progress.value.phase]).toEqual(['rest', 'done']);
});

test('a run that the core refuses is said so, with the last surface kept, dimmed', () => {
  const { store, columns, say, complete, start } = page();
  start(1);
  complete(1, 7);
  start(2);
  say(
    done(2, 'refused', 0, {
      progress: null,
      message: 'there is not enough memory for about 3000000 particles: choose fewer',
    }),
  );
  expect(store.notice.value).toMatchObject({
    id: 'size',
    kind: 'error',
    text: 'There is not enough memory for about 3000000 particles: choose fewer.',
  });
  expect(store.status.value).not.toBe('sampling');
  expect(columns.count).toBe(7);
  expect(told.at(-1)).toBe('dim');
  // Until fewer are asked for.
  start(3);
  expect(store.notice.value).toBe(null);
});

test('a drag is counted: what was asked for, what was shown, how late', () => {
  const { sampler, store, accept, finish } = page();
  sampler.sampleLive(request('x'), 3);
  sampler.sampleLive(request('y'), 3);
  sampler.sampleLive(request('z'), 3);
  accept(1);
  vi.advanceTimersByTime(20);
  finish(1, 7);
  accept(2);
  vi.advanceTimersByTime(30);
  finish(2, 7);
  expect(store.lastDrag.value).toMatchObject({ requested: 3, shown: 2, latency_ms: 30, particles: 7 });
});
