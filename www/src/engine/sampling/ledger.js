/**
 * What the page knows of the runs it has sent: a record that only {@link reduce} replaces, and functions of it. All
 * functions are pure: the sampler passes events and acts on the result.
 *
 * @module
 */
import { clampSettings } from '../share/state.js';
import { KINDS } from './kinds.js';

/**
 * @import { Description, Status, Trial } from '../types.js'
 * @import { Job, Ledger, LedgerEvent, Outcome, Run, SampleJob, Shown, Stage } from './types.js'
 */

/** @type {Ledger} */
export const IDLE = Object.freeze({
  lastId: 0,
  asked: [],
  current: null,
  held: 0,
  accepted: null,
  shown: null,
  stood: null,
  astray: false,
  endedMs: 0,
  stoppedUpTo: 0,
  crashedInput: '',
});

/** @param {Ledger} state @param {LedgerEvent} event @returns {Ledger} */
export function reduce(state, event) {
  switch (event.type) {
    case 'sent': {
      const { job, nowMs } = event;
      const id = state.lastId + 1;
      /** @type {Run} */
      const run = { id, job, bounds: null, stage: 'seeding', sinceMs: nowMs };
      const next = { ...state, lastId: id };
      // A relaxation sets no field, so it is current at once.
      return job.kind === 'relax' ? { ...next, current: run } : { ...next, asked: [...state.asked, run] };
    }
    case 'accepted': {
      const run = askedFor(state, event.id);
      if (!run || run.job.kind === 'relax') return state;
      const { job } = run;
      // The time it waited for the previous run is no part of its own cost.
      const sinceMs = Math.max(run.sinceMs, state.endedMs);
      return {
        ...state,
        asked: after(state.asked, event.id),
        current: { ...run, bounds: event.bounds, sinceMs },
        held: 0,
        accepted: job.kind === 'backdrop' ? state.accepted : job,
        astray: KINDS[job.kind].restores === true && state.astray,
      };
    }
    case 'boxed':
      return { ...state, current: state.current && { ...state.current, bounds: event.bounds } };
    case 'refused':
      return { ...state, asked: after(state.asked, event.id) };
    case 'dropped':
      return { ...state, asked: after(state.asked, event.id), astray: true };
    case 'particles':
      return firstParticles(state, event.description);
    case 'done':
      return done(state, event);
    case 'reported':
      return { ...atStage(state, 'over'), shown: state.shown && { ...state.shown, reported: true } };
    case 'committed':
      return committed(state);
    case 'stopped':
      return { ...state, stoppedUpTo: state.lastId };
    case 'lost':
      return { ...state, asked: [], current: null, held: 0 };
    case 'crashed':
      return { ...state, crashedInput: event.input, astray: state.astray || (event.input !== '' && !event.again) };
    case 'revived':
      return { ...state, crashedInput: '' };
  }
}

/** @param {Ledger} state @param {Description | null} description @returns {Ledger} */
function firstParticles(state, description) {
  const { current, shown } = state;
  if (current?.stage !== 'seeding') return state;
  const { job } = current;
  const next = atStage(state, 'growing');
  if (job.kind === 'backdrop') return { ...next, shown: null };
  if (job.kind !== 'relax') {
    const stood = job.kind === 'trial' ? (state.stood ?? shown) : null;
    return { ...next, shown: { job, reported: false }, stood };
  }
  return { ...next, shown: shown && { job: relaxed(shown, job.steps, description), reported: false } };
}

/** @param {Ledger} state @param {Extract<LedgerEvent, {type: 'done'}>} event */
function done(state, { outcome, particles, reportFollows, nowMs }) {
  const { current, shown, accepted } = state;
  if (!current) return state;
  const { kind } = current.job;
  const next = { ...atStage(state, reportFollows ? 'measuring' : 'over'), endedMs: nowMs };
  if (kind === 'backdrop') return next;
  if (tookPlace(outcome, particles)) {
    if (particles > 0) return { ...next, held: current.id };
    if (!state.stood || !shown) return { ...next, held: 0, shown: null, stood: state.stood ?? shown };
    // The surface of a trial stays until the previous one is back.
    return { ...next, held: 0 };
  }
  // The previous surface stays. It counts as the requested one if the stopped run had the same field.
  const wanted = current.job.kind === 'relax' ? accepted : current.job;
  const same = JSON.stringify(shown?.job.field) === JSON.stringify(wanted?.field);
  return { ...next, astray: KINDS[kind].restores === true || outcome !== 'stopped' || !same };
}

/** @param {Ledger} state @returns {Ledger} */
function committed(state) {
  /** @type {(run: Run) => Run} */
  const kept = (run) => (run.job.kind === 'trial' ? { ...run, job: { ...run.job, kind: 'change' } } : run);
  const { current, shown } = state;
  const isAwaited = current?.stage === 'seeding' || state.asked.length > 0;
  return {
    ...state,
    asked: state.asked.map(kept),
    current: current && kept(current),
    stood: shown && !isAwaited ? null : state.stood,
  };
}

/** Returns the result of the last trial. @param {Ledger} state @returns {Trial} */
export function trialOf({ stood, shown, current }) {
  if (stood && shown) return 'shown';
  return current && KINDS[current.job.kind].restores ? 'back' : 'none';
}

/** Returns the run that restores a surface. @param {Shown} shown @returns {SampleJob} */
const restored = ({ job }) => ({ ...job, kind: 'restore' });

/** Whether nothing was requested since the last stop. Then no run starts. @param {Ledger} state */
const isStopped = ({ lastId, stoppedUpTo }) => lastId === stoppedUpTo;

/**
 * Returns the run after a trial without a surface: it restores the previous surface as a backdrop. Null in any other
 * case, after a stop, or if a later one has been sent.
 * @param {Ledger} state
 * @returns {SampleJob | null}
 */
export function backdropOf(state) {
  const { asked, shown, stood } = state;
  return stood && shown && asked.length === 0 && !isStopped(state) ? { ...stood.job, kind: 'backdrop' } : null;
}

/**
 * Returns the run after a failed run: it completes the surface that stays, or restores the one before a trial. Null
 * if that surface is already there, after a stop, or if a later one has been sent.
 * @param {Ledger} state
 * @returns {SampleJob | null}
 */
export function restoringOf(state) {
  const { asked, current, shown, stood, crashedInput } = state;
  const isRestored = current !== null && KINDS[current.job.kind].restores && current.stage !== 'over';
  if (!shown || asked.length > 0 || isRestored || isStopped(state)) return null;
  const isTried = stood !== null || runningOf(state)?.job.kind === 'trial';
  if (!isTried && (shown.reported || statusOf(state) !== 'rest')) return null;
  const job = restored(stood ?? shown);
  return inputOf(job) === crashedInput ? null : job;
}

/** @param {Ledger} state @param {Stage} stage @returns {Ledger} */
const atStage = (state, stage) => ({ ...state, current: state.current && { ...state.current, stage } });

/**
 * Returns the jobs sent after `id`. The worker answers in order, so it skipped earlier jobs without an answer.
 * @param {readonly Run[]} asked
 * @param {number} id
 */
const after = (asked, id) => asked.filter((run) => run.id > id);

/** Returns the job with this id if its field has not been answered. @param {Ledger} state @param {number} id */
export const askedFor = ({ asked }, id) => asked.find((run) => run.id === id);

/**
 * Returns the job that the worker has or will have next: the last one sent, or the one that continues because the later
 * field was refused. A job ends before its report.
 * @param {Ledger} state
 */
export function runningOf({ asked, current }) {
  if (asked.length > 0) return asked[asked.length - 1];
  return current?.stage === 'seeding' || current?.stage === 'growing' ? current : null;
}

/** Returns what the page waits for: particles, their report, or nothing. @param {Ledger} state @returns {Status} */
export function statusOf(state) {
  if (runningOf(state)) return 'sampling';
  return state.current?.stage === 'measuring' ? 'measuring' : 'rest';
}

/**
 * Whether a run with this outcome has made a surface.
 * @param {Outcome} outcome
 * @param {number} particles
 */
export const tookPlace = (outcome, particles) => outcome === 'complete' || (outcome === 'stopped' && particles > 0);

/** Returns a key to compare the inputs of runs. @param {Job} job */
export const inputOf = (job) => JSON.stringify(job.kind === 'relax' ? ['relax', job.steps] : [job.field, job.settings]);

/**
 * Returns the run that makes the surface on the page again, with this many more relaxation steps.
 * @param {Shown} shown @param {number} steps
 * @param {Description | null} description  with the ranges of the settings
 * @returns {SampleJob}
 */
export function relaxed({ job }, steps, description) {
  const settings = { ...job.settings, relax_steps: Number(job.settings.relax_steps) + steps };
  const isKept = job.kind === 'trial' || job.kind === 'rest' || job.kind === 'restore';
  return {
    ...job,
    kind: isKept ? job.kind : 'again',
    settings: description ? clampSettings(description, settings) : settings,
  };
}

/**
 * Returns the run that is lost with the worker: the current run, or, for a pending report or a relaxation, the run that
 * leads to the same particles again. Null after a stop.
 * @param {Ledger} state @param {Description | null} description
 * @returns {SampleJob | null}
 */
export function lostRun(state, description) {
  if (isStopped(state)) return null;
  const { shown, current } = state;
  const atWorker = runningOf(state)?.job ?? null;
  if (atWorker && atWorker.kind !== 'relax') return atWorker;
  if (!shown || (!atWorker && shown.reported)) return null;
  return relaxed(shown, atWorker && current?.stage === 'seeding' ? atWorker.steps : 0, description);
}
