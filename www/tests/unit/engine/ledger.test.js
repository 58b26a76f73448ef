import { describe, expect, test } from 'vitest';
import {
  backdropOf,
  IDLE,
  inputOf,
  lostRun,
  reduce,
  relaxed,
  restoringOf,
  statusOf,
  trialOf,
} from '../../../src/engine/sampling/ledger.js';
import { description } from './description.js';

/**
 * @import { Ledger, LedgerEvent, Outcome, SampleJob } from '../../../src/engine/sampling/types.js'
 * @import { Bounds } from '../../../src/engine/types.js'
 */

const { bounds } = description.surfaces[0];

/** @param {string} formula @param {Partial<SampleJob>} [more] @returns {SampleJob} */
const wish = (formula, more = {}) => ({
  kind: 'new',
  field: { formula },
  settings: { relax_steps: 10 },
  asksAbove: Infinity,
  ...more,
});
/** @param {SampleJob} job @returns {LedgerEvent} */
const sent = (job) => ({ type: 'sent', job, nowMs: 0 });
/** @param {number} of @param {number} steps @returns {LedgerEvent} */
const relax = (of, steps) => ({
  type: 'sent',
  job: { kind: 'relax', of, steps },
  nowMs: 0,
});
/** @param {number} id @returns {LedgerEvent} */
const accepted = (id) => ({ type: 'accepted', id, bounds });
/** @type {LedgerEvent} */
const particles = { type: 'particles', description };
/** @param {Outcome} outcome @param {number} n @param {boolean} [reportFollows] @returns {LedgerEvent} */
const done = (outcome, n, reportFollows = false) => ({
  type: 'done',
  outcome,
  particles: n,
  reportFollows,
  nowMs: 40,
});

/**
 * What has come of these events. No state is changed: each is frozen before the next event.
 * @param {LedgerEvent[]} events
 */
const stateAfter = (...events) => events.reduce((state, event) => Object.freeze(reduce(state, event)), IDLE);

/** A whole run of x, with its report. */
const whole = () => [sent(wish('x')), accepted(1), particles, done('complete', 7, true), { type: 'reported' }];
/** @type {(...more: LedgerEvent[]) => Ledger} */
const afterWhole = (...more) => stateAfter(.../** @type {LedgerEvent[]} */ (whole()), ...more);

describe('a run', () => {
  test('has the box that was found for it, and not that of its field before', () => {
    /** @type {Bounds} */
    const found = { min: [-9, -9, -9], max: [9, 9, 9] };
    expect(stateAfter({ type: 'boxed', bounds: found }).current).toBeNull();
    const state = stateAfter(sent(wish('x')), accepted(1), { type: 'boxed', bounds: found });
    expect(state.current?.bounds).toEqual(found);
    expect(state.current?.stage).toBe('seeding');
  });

  test('goes through its stages, and is waited for by the page and by the worker as long as each has to', () => {
    const seen = whole().map((_, k) => {
      const state = stateAfter(.../** @type {LedgerEvent[]} */ (whole()).slice(0, k + 1));
      return [state.current?.stage, statusOf(state)];
    });
    expect(seen).toEqual([
      [undefined, 'sampling'],
      ['seeding', 'sampling'],
      ['growing', 'sampling'],
      ['measuring', 'measuring'],
      ['over', 'rest'],
    ]);
  });

  test('is on the page from its first particle on, and held by the worker from its end on', () => {
    const state = stateAfter(sent(wish('x')), accepted(1), particles);
    expect(state).toMatchObject({ held: 0, shown: { job: wish('x'), reported: false } });
    expect(afterWhole()).toMatchObject({ held: 1, shown: { reported: true }, astray: false });
  });

  test('takes over when its field is accepted, and those asked before it are forgotten', () => {
    const state = stateAfter(sent(wish('x')), sent(wish('y')), sent(wish('z')), accepted(2));
    expect(state.current).toMatchObject({ id: 2, bounds, stage: 'seeding' });
    expect(state.asked.map((run) => run.id)).toEqual([3]);
    expect(state.accepted).toEqual(wish('y'));
    // An answer about one of them changes nothing any more.
    expect(reduce(state, accepted(1))).toBe(state);
  });

  test('whose field is refused leaves the one before as it is', () => {
    const before = stateAfter(sent(wish('x')), accepted(1), particles);
    const state = reduce(reduce(before, sent(wish('x+'))), { type: 'refused', id: 2 });
    expect(state).toEqual({ ...before, lastId: 2 });
  });

  test('without a surface leaves nothing held or shown', () => {
    expect(afterWhole(sent(wish('y')), accepted(2), done('complete', 0))).toMatchObject({ held: 0, shown: null });
  });
});

test('the time that a run has waited for the one before it is not its own', () => {
  const state = stateAfter(sent(wish('x')), accepted(1), sent(wish('y')), done('complete', 7), accepted(2));
  expect(state.current?.sinceMs).toBe(40);
});

describe('the surface on the page is not the one asked for', () => {
  test.each(/** @type {const} */ (['ask', 'refused', 'lost']))('after a run that ended with %s', (outcome) => {
    const state = afterWhole(sent(wish('x')), accepted(2), done(outcome, 0));
    expect(state).toMatchObject({ astray: true, held: 0, shown: { reported: true } });
    // The next that is accepted is on its way.
    expect(reduce(reduce(state, sent(wish('z'))), accepted(3)).astray).toBe(false);
  });

  test('after another was stopped before its first particle, and not after the same was', () => {
    expect(afterWhole(sent(wish('y')), accepted(2), done('stopped', 0)).astray).toBe(true);
    expect(afterWhole(sent(wish('x')), accepted(2), done('stopped', 0)).astray).toBe(false);
  });

  test('while it is only restored', () => {
    const restoring = sent(wish('x', { kind: 'restore' }));
    const state = afterWhole(sent(wish('y')), accepted(2), done('refused', 0), restoring, accepted(3));
    expect(state.astray).toBe(true);
    expect(reduce(state, done('stopped', 0)).astray).toBe(true);
  });

  test('after the worker failed on another for good', () => {
    const input = inputOf(wish('y'));
    const lost = afterWhole(sent(wish('y')), { type: 'lost' });
    expect(reduce(lost, { type: 'crashed', input, again: true }).astray).toBe(false);
    expect(reduce(lost, { type: 'crashed', input, again: false })).toMatchObject({ astray: true, crashedInput: input });
    expect(reduce(lost, { type: 'crashed', input: '', again: false }).astray).toBe(false);
  });
});

describe('a relaxation', () => {
  test('has no field to wait for, and makes what is shown a run of as many steps more', () => {
    const begun = afterWhole(relax(1, 5));
    expect(begun.current).toMatchObject({ id: 2, stage: 'seeding' });
    expect(begun.shown?.job.settings.relax_steps).toBe(10);
    const moved = reduce(begun, particles);
    expect(moved.shown).toMatchObject({ reported: false, job: { settings: { relax_steps: 15 }, kind: 'again' } });
    // Only the first particles count.
    expect(reduce(moved, particles)).toBe(moved);
  });

  test('of more steps than the core accepts is one of as many as it does', () => {
    const shown = { job: wish('x'), reported: true };
    expect(relaxed(shown, 5000, description).settings.relax_steps).toBe(1000);
  });
});

describe('when the worker goes', () => {
  test('nothing is under way, and what is shown stays', () => {
    const state = afterWhole(sent(wish('y')), accepted(2), sent(wish('z')), { type: 'lost' });
    expect(state).toMatchObject({ asked: [], current: null, held: 0, shown: { reported: true } });
    expect(statusOf(state)).toBe('rest');
  });

  test('the run it was at is lost', () => {
    expect(lostRun(afterWhole(sent(wish('y'))), description)).toEqual(wish('y'));
  });

  test('nothing is lost with a worker that was idle', () => {
    expect(lostRun(afterWhole(), description)).toBe(null);
    expect(lostRun(IDLE, description)).toBe(null);
  });

  test('a report that is owed is made with its run', () => {
    const state = stateAfter(sent(wish('x')), accepted(1), particles, done('complete', 7, true));
    expect(lostRun(state, description)).toEqual(wish('x', { kind: 'again' }));
  });

  test('a relaxation is made with the run that it goes on with, and its steps count once', () => {
    const before = afterWhole(relax(1, 5));
    expect(lostRun(before, description)?.settings.relax_steps).toBe(15);
    expect(lostRun(reduce(before, particles), description)?.settings.relax_steps).toBe(15);
  });
});

test('what was sent last is lost first, and once', () => {
  const live = (/** @type {string} */ formula) => wish(formula, { kind: 'live' });
  const state = stateAfter(sent(live('x')), accepted(1), sent(live('y')));
  expect(lostRun(state, description)).toEqual(live('y'));
  expect(lostRun(reduce(state, { type: 'lost' }), description)).toBe(null);
});

test('a stop holds for every job sent before it', () => {
  expect(stateAfter(sent(wish('x')), { type: 'stopped' }).stoppedUpTo).toBe(1);
});

test('a run that a stop has dropped is waited for no more, and the surface is not the one that was asked for', () => {
  const state = stateAfter(sent(wish('x')), accepted(1), particles, sent(wish('y', { kind: 'live' })));
  const next = reduce(state, { type: 'dropped', id: 2 });
  expect(next).toMatchObject({ asked: [], astray: true, current: { id: 1 }, accepted: wish('x') });
  expect(statusOf(reduce(next, done('stopped', 5)))).toBe('rest');
});

test('a worker started again by hand may be sent what the last failed on', () => {
  expect(stateAfter({ type: 'crashed', input: 'x', again: false }, { type: 'revived' }).crashedInput).toBe('');
});

describe('a formula that is being typed', () => {
  const trial = (/** @type {string} */ formula, /** @type {number} */ id) => [
    sent(wish(formula, { kind: 'trial' })),
    accepted(id),
    particles,
    done('complete', 5),
  ];

  test('is on trial: of any number of its beginnings, the surface before the first comes back', () => {
    const state = afterWhole(...trial('xy', 2), ...trial('xyz', 3));
    expect(trialOf(state)).toBe('shown');
    const back = restoringOf(reduce(state, sent(wish('xyz+', { kind: 'trial' }))));
    expect(back).toBeNull();
    const refused = reduce(reduce(state, sent(wish('xyz+', { kind: 'trial' }))), { type: 'refused', id: 4 });
    expect(restoringOf(refused)).toMatchObject({ field: { formula: 'x' }, kind: 'restore' });
  });

  test('without a surface has the one before as a backdrop, which is nobody’s surface but comes back again', () => {
    const none = [sent(wish('xyz=-1', { kind: 'trial' })), accepted(3), done('complete', 0)];
    const state = afterWhole(...trial('xy', 2), .../** @type {LedgerEvent[]} */ (none));
    const behind = backdropOf(state);
    if (!behind) throw new Error('Nothing comes back.');
    expect(behind).toMatchObject({ field: { formula: 'x' }, kind: 'backdrop' });
    // What was asked for meanwhile goes first.
    expect(backdropOf(reduce(state, sent(wish('z'))))).toBeNull();
    const events = /** @type {LedgerEvent[]} */ ([sent(behind), accepted(4), particles, done('complete', 7)]);
    const after = events.reduce(reduce, state);
    expect(after).toMatchObject({ held: 0, shown: null, stood: { job: { field: { formula: 'x' } } } });
    expect(trialOf(after)).toBe('back');
    expect(trial('xyz', 5).reduce(reduce, after).stood?.job.field.formula).toBe('x');
  });

  test('stays once it is committed, or sampled by any other control', () => {
    const state = afterWhole(...trial('xy', 2), { type: 'committed' });
    expect(state.stood).toBeNull();
    expect(trialOf(state)).toBe('none');
    expect(restoringOf(state)).toMatchObject({ field: { formula: 'xy' } });
    expect(afterWhole(...trial('xy', 2), sent(wish('xyz')), accepted(3), particles).stood).toBeNull();
    // A commitment that comes before the particles is kept for them.
    const early = [...trial('xy', 2).slice(0, 2), { type: 'committed' }, particles];
    expect(afterWhole(.../** @type {LedgerEvent[]} */ (early)).stood).toBeNull();
  });
});
