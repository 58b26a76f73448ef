import { effect } from '@preact/signals-core';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { description } from './description.js';
import { begin, columnsMessage, done, page, progress, reportMessage, request, told, workers } from './sampler-page.js';

beforeEach(begin);
afterEach(() => vi.useRealTimers());

describe('a formula with a fault', () => {
  const fault = {
    ok: false,
    error: { kind: 'unexpected_end', message: 'no', start: 0, end: 1, suggestion: null, mended: null, name: null },
  };

  test('leaves the last surface, dimmed', () => {
    const { sampler, store, columns, say, complete, start } = page();
    start(1);
    complete(1, 7);
    told.length = 0;
    sampler.sample(request('x+'));
    say({ type: 'field', id: 2, answer: fault });
    expect(columns.count).toBe(7);
    expect(store.field.value?.formula).toBe('x');
    expect(store.fieldError.value).toMatchObject({ kind: 'unexpected_end' });
    expect(told).toEqual(['dim']);
    expect(store.status.value).not.toBe('sampling');
  });

  test('that is just an empty editor dims nothing', () => {
    const { sampler, say } = page();
    sampler.sample(request(''));
    told.length = 0;
    say({ type: 'field', id: 1, answer: { ok: false, error: { ...fault.error, kind: 'empty' } } });
    expect(told).toEqual(['clear']);
  });

  test('that is the first of all is the end of it', () => {
    const { sampler, store, say } = page();
    sampler.sample(request('x+'));
    say({ type: 'field', id: 1, answer: fault });
    expect(store.status.value).not.toBe('sampling');
    expect(store.progress.value.phase).toBe('done');
  });

  test('typed during a run lets that run go on, dimmed, with its figures', () => {
    const { sampler, store, columns, say, accept, jobs } = page();
    sampler.sample(request('x', { kind: 'new' }));
    accept(1);
    sampler.sample(request('x+'));
    // What comes before the answer is the run's too.
    say(columnsMessage(1, 3));
    say({ type: 'field', id: 2, answer: fault });
    expect(store.status.value).toBe('sampling');
    say(columnsMessage(1, 7));
    expect(columns.count).toBe(7);
    expect(told.slice(told.lastIndexOf('dim'))).not.toContain('clear');
    say(done(1, 'complete', 7, { reportFollows: true }));
    expect(store.status.value).not.toBe('sampling');
    expect(told.at(-1)).toBe('fit');
    say(reportMessage(1, 7));
    expect(store.report.value?.count).toBe(7);
    expect(store.fieldError.value).toMatchObject({ kind: 'unexpected_end' });
    expect(jobs()).toHaveLength(2);
  });

  test('dims also what comes to the page only after it', () => {
    const { sampler, say, start } = page();
    start(1);
    sampler.sample(request('x+'));
    say({ type: 'field', id: 2, answer: fault });
    say(columnsMessage(1, 7));
    expect(told.at(-2)).toBe('dim');
  });

  test('typed during a measurement lets the figures come', () => {
    const { sampler, store, say, start } = page();
    start(1);
    say(columnsMessage(1, 7));
    say(done(1, 'complete', 7, { reportFollows: true }));
    sampler.sample(request('x+'));
    say({ type: 'field', id: 2, answer: fault });
    expect(store.status.value).not.toBe('sampling');
    say(reportMessage(1, 7));
    expect(store.report.value?.count).toBe(7);
    // And the surface that stayed can be relaxed on.
    sampler.relax(1);
    expect(workers[0].posted.at(-1)).toMatchObject({ job: { kind: 'relax', of: 1 } });
  });

  test('that was followed by another that is accepted is forgotten, answered or not', () => {
    const { sampler, store, accept, finish } = page();
    sampler.sample(request('x'));
    sampler.sample(request('x+'));
    sampler.sample(request('y'));
    accept(1);
    expect(store.status.value).toBe('sampling');
    accept(3, 'y');
    finish(3, 7);
    expect(store.status.value).not.toBe('sampling');
    expect(store.field.value?.formula).toBe('y');
  });

  test('taken back while the run before it is under way is no fault any more', () => {
    const { sampler, store, say, start } = page();
    start(1);
    sampler.sample(request('x+'));
    say({ type: 'field', id: 2, answer: fault });
    start(3);
    expect(store.fieldError.value).toBe(null);
  });

  test('and the worker’s end in the middle of the run before it: that run is made again', () => {
    const { sampler, say, start, jobs } = page();
    start(1);
    sampler.sample(request('x+'));
    say({ type: 'field', id: 2, answer: fault });
    say({ type: 'crashed', id: 1, message: 'unreachable', stack: '' });
    expect(jobs()).toMatchObject([{ field: { formula: 'x' } }]);
  });
});

describe('the surface that stays', () => {
  test('because another would need too many particles, or is refused, gets the figures it has not had', () => {
    for (const outcome of ['ask', 'refused']) {
      const { store, say, accept, complete, start, jobs } = page();
      start(1);
      say(columnsMessage(1, 7));
      start(2, 'y');
      say(done(2, outcome, 0, { progress: null }));
      expect(told.at(-1)).toBe('dim');
      expect(jobs().at(-1)).toMatchObject({ id: 3, kind: 'restore', field: { formula: 'x' } });
      accept(3);
      expect(store.field.value?.formula).toBe('y');
      complete(3, 9);
      expect(store.report.value?.count).toBe(9);
      expect(told.slice(told.lastIndexOf('dim'))).not.toContain('clear');
      // With its figures there it is left alone.
      start(4, 'z');
      say(done(4, outcome, 0, { progress: null }));
      expect(jobs()).toHaveLength(4);
      expect(store.report.value?.count).toBe(9);
    }
  });

  test('is made with the relaxation that another cut off', () => {
    const { sampler, say, complete, start, jobs } = page();
    start(1);
    complete(1, 7);
    sampler.relax(1);
    say(columnsMessage(2, 7));
    start(3, 'y');
    say(done(3, 'refused', 0, { progress: null }));
    expect(jobs().at(-1)).toMatchObject({ kind: 'restore', field: { formula: 'x' }, settings: { relax_steps: 11 } });
  });

  test('is the one asked for again where it is asked for while it is being restored', () => {
    const { sampler, store, say, accept, start, finish, jobs } = page();
    start(1);
    say(columnsMessage(1, 7));
    start(2, 'y');
    say(done(2, 'ask', 0, { progress: null }));
    accept(3);
    sampler.sample(request('x'));
    expect(jobs()).toHaveLength(4);
    accept(4);
    finish(4, 7);
    expect(store.field.value?.formula).toBe('x');
    expect(told.slice(told.lastIndexOf('dim'))).toContain('clear');
  });

  test('stays dimmed where its restoring is stopped at once, or the worker fails while it is idle', () => {
    for (const end of ['stop', 'crash']) {
      const { sampler, say, accept, start } = page();
      start(1);
      say(columnsMessage(1, 7));
      if (end === 'crash') {
        say(done(1, 'complete', 7, { reportFollows: true }));
        say(reportMessage(1, 7));
      }
      start(2, 'y');
      say(done(2, 'refused', 0, { progress: null }));
      if (end === 'stop') {
        accept(3);
        sampler.stop();
        say(done(3, 'stopped', 0));
      } else {
        say({ type: 'crashed', id: 0, message: 'unreachable', stack: '' });
      }
      expect(told.at(-1), end).toBe('dim');
    }
  });

  test('from a drag that a mistake broke off gets its figures', () => {
    for (const end of ['mistake', 'mistake meanwhile']) {
      const { sampler, accept, finish, refuse, jobs } = page();
      const ended = () => {
        finish(1, 7);
      };
      sampler.sampleLive(request('x'), 3);
      accept(1);
      if (end === 'mistake') ended();
      expect(jobs()).toHaveLength(1);
      sampler.sample(request('x+'));
      refuse(2);
      if (end === 'mistake meanwhile') ended();
      expect(jobs().at(-1)).toMatchObject({ kind: 'restore', field: { formula: 'x' } });
    }
  });

  test('because the sampler fails on every other is dimmed and gets its figures', () => {
    const { say, accept, start, jobs } = page();
    const crash = { type: 'crashed', id: 1, message: 'unreachable', stack: '' };
    start(1);
    say(columnsMessage(1, 7));
    say(done(1, 'complete', 7, { reportFollows: true }));
    start(2, 'y');
    say(crash);
    accept(3, 'y');
    say(crash);
    expect(told.at(-1)).toBe('dim');
    expect(jobs()).toMatchObject([{ kind: 'restore', field: { formula: 'x' } }]);
  });

  test('because the same was sampled anew and stopped at once is not dimmed', () => {
    const { columns, say, complete, start } = page();
    start(1);
    complete(1, 7);
    start(2);
    say(done(2, 'stopped', 0));
    expect(columns.count).toBe(7);
    expect(told.at(-1)).toBe('clear');
  });

  test('because the next was stopped before its first particle is whole, and dimmed', () => {
    const { sampler, store, columns, say, complete, start } = page();
    start(1);
    complete(1, 7);
    start(2, 'y');
    sampler.stop();
    say(columnsMessage(2, 0));
    say(done(2, 'stopped', 0));
    expect(columns).toMatchObject({ count: 7, stale: false });
    expect(store.result.value).not.toBe('partial');
    expect(store.report.value?.count).toBe(7);
    expect(store.progress.value).toMatchObject({ phase: 'done', particles: 7 });
    expect(told.at(-1)).toBe('dim');
  });

  test('keeps its figures until there are particles of another', () => {
    const { store, say, complete, start } = page();
    start(1);
    complete(1, 7);
    start(2, 'y');
    expect(store.report.value?.count).toBe(7);
    say(columnsMessage(2, 5));
    expect(store.report.value).toBe(null);
  });
});

describe('a stop starts no run', () => {
  /** Begins a run of x, of which the page has 7 particles, and asks for one of y, which is accepted. */
  function halfway() {
    const it = page();
    it.start(1);
    it.say(columnsMessage(1, 7));
    it.start(2, 'y');
    return it;
  }

  test('after the field of the next was accepted: the part of the surface that is there stays, dimmed', () => {
    const { sampler, store, columns, say, jobs } = halfway();
    sampler.stop();
    say(done(2, 'stopped'));
    expect(jobs()).toHaveLength(2);
    expect(columns).toMatchObject({ count: 7, record: null });
    expect(store.result.value).toBe('partial');
    expect([store.status.value === 'sampling', store.progress.value.phase, told.at(-1)]).toEqual([
      false,
      'done',
      'dim',
    ]);
  });

  test('before the field of the next is refused, although the surface of a drag has no figures', () => {
    const { sampler, accept, finish, refuse, jobs } = page();
    sampler.sampleLive(request('x'), 3);
    accept(1);
    finish(1, 7);
    sampler.sample(request('x+'));
    sampler.stop();
    refuse(2);
    expect(jobs()).toHaveLength(2);
  });

  test('before a formula that is typed turns out to have no surface', () => {
    const { sampler, say, accept, complete, start, jobs } = page();
    start(1);
    complete(1, 7);
    for (const [id, formula] of /** @type {const} */ ([
      [2, 'y'],
      [3, 'yz'],
    ])) {
      sampler.sample(request(formula, { kind: 'trial' }));
      accept(id, formula);
      if (id === 2) complete(id, 5);
    }
    sampler.stop();
    say(done(3, 'complete'));
    expect(jobs()).toHaveLength(3);
  });

  test('before the worker fails, and the next that is asked for is sampled', () => {
    const { sampler, say, jobs } = halfway();
    sampler.stop();
    say({ type: 'crashed', id: 2, message: 'unreachable', stack: '' });
    expect(workers).toHaveLength(2);
    expect(jobs()).toEqual([]);
    sampler.sample(request('y'));
    expect(jobs()).toHaveLength(1);
  });

  test('at rest, also after a drag, whose last surface has no figures', () => {
    const { sampler, accept, finish, jobs } = page();
    sampler.sampleLive(request('x'), 3);
    accept(1);
    finish(1, 7);
    sampler.stop();
    expect(jobs()).toHaveLength(1);
  });
});

describe('a worker that fails', () => {
  const crash = { type: 'crashed', id: 1, message: 'panicked at src/x.rs', stack: 'at f' };

  test('is replaced, and its run made again', () => {
    const { sampler, store, say, jobs } = page();
    sampler.sample(request('x'));
    const rests = /** @type {boolean[]} */ ([]);
    effect(() => void rests.push(store.status.value !== 'sampling' && store.progress.value.phase === 'done'));
    say(crash);
    expect(rests).not.toContain(true);
    expect(workers).toHaveLength(2);
    expect(jobs()).toHaveLength(1);
    expect(jobs()[0].field).toEqual({ formula: 'x' });
    expect(store.notice.value).toMatchObject({ id: 'panic', kind: 'warn' });
    expect(store.notice.value?.details).toContain('panicked at src/x.rs');
    expect(told.filter((t) => t === 'ready')).toHaveLength(1);
  });

  test('twice on the same input is not sent it a third time', () => {
    const { sampler, store, say, jobs } = page();
    sampler.sample(request('x'));
    say(crash);
    say(crash);
    expect(workers).toHaveLength(3);
    expect(jobs()).toHaveLength(0);
    expect(store.notice.value?.kind).toBe('error');
    expect(store.status.value).not.toBe('sampling');
    expect(store.progress.value.phase).toBe('done');
    expect(store.status.value).not.toBe('sampling');
    sampler.sample(request('y'));
    expect(jobs()).toHaveLength(1);
  });

  test('in the middle of a measurement owes the figures: that run is made again', () => {
    const { store, say, start, jobs } = page();
    start(1);
    say(columnsMessage(1, 7));
    say(done(1, 'complete', 7, { reportFollows: true }));
    say(crash);
    expect(jobs()).toMatchObject([{ kind: 'again', field: { formula: 'x' } }]);
    expect(store.status.value).toBe('sampling');
  });

  test('by silence is replaced too', () => {
    const { sampler, store, jobs } = page();
    sampler.sample(request('x'));
    vi.advanceTimersByTime(4500);
    expect(workers).toHaveLength(2);
    expect(jobs()).toHaveLength(1);
    expect(store.notice.value?.id).toBe('hang');
  });

  test('by silence while a file is written leaves nobody waiting for it', async () => {
    const { sampler, say, complete, start } = page();
    start(1);
    complete(1, 7);
    const file = sampler.client.meshFile({ format: 'ply' });
    // Nothing else is under way that the silence would break off.
    vi.advanceTimersByTime(4500);
    await expect(file).rejects.toThrow('does not hold');
    expect(workers).toHaveLength(2);
    // A file that came is waited for no longer.
    const next = sampler.client.meshFile({ format: 'ply' });
    say({ type: 'ready', description });
    say({ type: 'file', request: 2, bytes: Uint8Array.of(1) });
    expect(await next).toEqual(Uint8Array.of(1));
    vi.advanceTimersByTime(10_000);
    expect(workers).toHaveLength(2);
  });

  test('four times in a minute leaves the page in safe mode, with its state, until a person asks', () => {
    const { sampler, store, columns, say, accept, finish, jobs } = page();
    sampler.sample(request('kept'));
    accept(1);
    finish(1, 7);
    for (let k = 0; k < 4; k += 1) {
      sampler.sample(request(`formula ${k}`));
      say({ ...crash, id: 0 });
    }
    expect(store.notice.value?.id).toBe('safe-mode');
    expect(store.status.value).not.toBe('sampling');
    expect(columns.count).toBe(7);
    sampler.sample(request('later'));
    expect(store.status.value).not.toBe('sampling');
    store.notice.value?.action?.run();
    expect(store.notice.value).toBe(null);
    expect(jobs()[0].field).toMatchObject({ formula: 'whole' });
  });

  test('after it, relaxing makes the whole run again with the steps added', () => {
    const { sampler, say, accept, complete, start, jobs } = page();
    start(1);
    say(columnsMessage(1, 7));
    say({ ...done(1, 'complete', 7), progress: progress(7, { phase: 'done', relax_step: 10, relax_steps: 10 }) });
    sampler.relax(5);
    expect(jobs()[1]).toMatchObject({ kind: 'relax', of: 1, steps: 5 });
    say(columnsMessage(2, 7));
    say({ ...done(2, 'complete', 7), progress: progress(7, { phase: 'done', relax_step: 15, relax_steps: 15 }) });
    sampler.relax(1);
    expect(jobs()[2]).toMatchObject({ kind: 'relax', of: 2, steps: 1 });
    say(crash);
    // The relaxation that was lost cannot be made again on its own: the run that ends with it is.
    expect(jobs()).toMatchObject([{ kind: 'again', field: { formula: 'x' }, settings: { relax_steps: 16 } }]);
    accept(4);
    complete(4, 7);
    say(crash);
    expect(jobs()).toHaveLength(0);
    sampler.relax(2);
    expect(jobs()[0]).toMatchObject({ kind: 'change', field: { formula: 'whole' } });
  });

  test('to load says why, and tries again when asked', () => {
    const { sampler, store } = page();
    sampler.client.receive({
      type: 'failed',
      fault: 'missing',
      message: 'The sampler is not on the server.',
    });
    expect(store.notice.value).toMatchObject({ id: 'load', kind: 'error', text: 'The sampler is not on the server.' });
    store.notice.value?.action?.run();
    expect(workers).toHaveLength(2);
  });
});
