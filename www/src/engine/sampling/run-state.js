/**
 * The state of the runs, as a record that only {@link reduce} replaces, and functions of it. All functions are pure:
 * the client passes the events and acts on the result.
 *
 * @module
 */
import { clampSettings } from '../share/state.js';

/**
 * @import { Description, Trial } from '../types.js'
 * @import { Outcome, Run, RunEvent, RunRequest, RunState, SampleRequest, Shown, Stage } from './types.js'
 */

/**
 * Time after which a live job is replaced by one with newer values. Until then it continues; otherwise no job would
 * finish. So does the run that follows a drag, since the particles that it leaves can follow the surface again.
 */
const PATIENCE_MS = 150;

/** @type {RunState} */
export const IDLE = Object.freeze({
  lastId: 0,
  waiting: null,
  asked: [],
  current: null,
  held: 0,
  accepted: null,
  shown: null,
  stood: null,
  astray: false,
  stoppedUpTo: 0,
  crashedInput: '',
});

/** @param {RunState} state @param {RunEvent} event @returns {RunState} */
export function reduce(state, event) {
  switch (event.type) {
    case 'waits':
      return { ...state, waiting: event.request };
    case 'sent': {
      const { request, nowMs } = event;
      const id = state.lastId + 1;
      /** @type {Run} */
      const run = { id, request, bounds: null, stage: 'seeding', sinceMs: nowMs };
      const next = { ...state, lastId: id, waiting: null };
      // A relaxation sets no field, so it is current at once.
      return request.kind === 'relax' ? { ...next, current: run } : { ...next, asked: [...state.asked, run] };
    }
    case 'accepted': {
      const run = askedRun(state, event.id);
      if (run?.request.kind !== 'sample') return state;
      const { request } = run;
      return {
        ...state,
        asked: after(state.asked, event.id),
        current: { ...run, bounds: event.bounds },
        held: 0,
        accepted: request.backdrop ? state.accepted : request,
        astray: request.restoring === true && state.astray,
      };
    }
    case 'boxed':
      return { ...state, current: state.current && { ...state.current, bounds: event.bounds } };
    case 'refused':
      return { ...state, asked: after(state.asked, event.id) };
    case 'particles':
      return firstParticles(state, event.description);
    case 'done':
      return done(state, event);
    case 'reported':
      return { ...atStage(state, 'over'), shown: state.shown && { ...state.shown, reported: true } };
    case 'committed':
      return committed(state);
    case 'stopped':
      return { ...state, waiting: null, stoppedUpTo: state.lastId };
    case 'lost':
      return { ...state, waiting: null, asked: [], current: null, held: 0 };
    case 'crashed':
      return { ...state, crashedInput: event.input, astray: state.astray || (event.input !== '' && !event.again) };
    case 'revived':
      return { ...state, crashedInput: '' };
  }
}

/** @param {RunState} state @param {Description | null} description @returns {RunState} */
function firstParticles(state, description) {
  const { current, shown } = state;
  if (current?.stage !== 'seeding') return state;
  const { request } = current;
  const next = atStage(state, 'growing');
  if (request.backdrop) return { ...next, shown: null };
  if (request.kind === 'sample') {
    const stood = request.trial ? (state.stood ?? shown) : null;
    return { ...next, shown: { request, reported: false }, stood };
  }
  return { ...next, shown: shown && { request: relaxed(shown, request.steps, description), reported: false } };
}

/** @param {RunState} state @param {Extract<RunEvent, {type: 'done'}>} event */
function done(state, { outcome, particles, reportFollows }) {
  const { current, shown, accepted } = state;
  if (!current) return state;
  const next = atStage(state, reportFollows ? 'measuring' : 'over');
  if (current.request.backdrop) return next;
  if (tookPlace(outcome, particles)) {
    if (particles > 0) return { ...next, held: current.id };
    if (!state.stood || !shown) return { ...next, held: 0, shown: null, stood: state.stood ?? shown };
    // The surface of a trial stays until the one before it is back.
    const waiting = state.asked.length === 0 ? { ...restored(state.stood), live: true, backdrop: true } : null;
    return { ...next, held: 0, waiting };
  }
  // The previous surface stays. It still counts as the requested one if a run of the same field was stopped.
  const wanted = current.request.kind === 'sample' ? current.request : accepted;
  const same = JSON.stringify(shown?.request.field) === JSON.stringify(wanted?.field);
  return { ...next, astray: current.request.restoring === true || outcome !== 'stopped' || !same };
}

/** @param {RunState} state @returns {RunState} */
function committed(state) {
  const kept = (/** @type {Run} */ run) => ({
    ...run,
    request: { ...run.request, trial: /** @type {const} */ (false) },
  });
  const { current, shown } = state;
  const isAwaited = current?.stage === 'seeding' || state.asked.length > 0;
  return {
    ...state,
    asked: state.asked.map(kept),
    current: current && kept(current),
    stood: shown && !isAwaited ? null : state.stood,
  };
}

/** Returns what has become of the last trial. @param {RunState} state @returns {Trial} */
export function trialOf({ stood, shown, current }) {
  if (stood && shown) return 'shown';
  return current?.request.restoring ? 'back' : 'none';
}

/** Returns the run that makes a surface again. @param {Shown} shown @returns {SampleRequest} */
const restored = ({ request }) => ({ ...request, live: false, grow: false, fit: false, trial: false, restoring: true });

/**
 * Returns the run after a request that has failed: it completes the surface that stays, or brings back the one before a
 * trial. Null if that surface is there, or a later request is on its way.
 * @param {RunState} state
 * @returns {SampleRequest | null}
 */
export function restoringOf(state) {
  const { asked, current, shown, stood, crashedInput } = state;
  if (!shown || asked.length > 0 || (current?.request.restoring && current.stage !== 'over')) return null;
  const isTried = stood !== null || runningOf(state)?.request.trial;
  if (!isTried && (shown.reported || awaitsWorker(state))) return null;
  const request = restored(stood ?? shown);
  return inputOf(request) === crashedInput ? null : request;
}

/** @param {RunState} state @param {Stage} stage @returns {RunState} */
const atStage = (state, stage) => ({ ...state, current: state.current && { ...state.current, stage } });

/**
 * Returns the jobs sent after `id`. The worker answers in order, so earlier jobs without an answer were skipped.
 * @param {readonly Run[]} asked
 * @param {number} id
 */
const after = (asked, id) => asked.filter((run) => run.id > id);

/** Returns the job with this id if its field has not been answered. @param {RunState} state @param {number} id */
export const askedRun = ({ asked }, id) => asked.find((run) => run.id === id);

/**
 * Returns the job that the worker has or is about to have: the one sent last, or the one that goes on because its field
 * was refused. It ends before its report.
 * @param {RunState} state
 */
export function runningOf({ asked, current }) {
  if (asked.length > 0) return asked[asked.length - 1];
  return current?.stage === 'seeding' || current?.stage === 'growing' ? current : null;
}

/**
 * Returns whether a request waits for the job that runs. The latest one wins, and otherwise replaces that job.
 * @param {RunState} state @param {RunRequest} request @param {number} nowMs
 */
export function isToWait(state, request, nowMs) {
  const running = runningOf(state);
  if (!request.live || !(running?.request.live || running?.request.rests)) return false;
  return nowMs - running.sinceMs < PATIENCE_MS;
}

/** Returns whether the page waits for particles. @param {RunState} state */
export const awaitsParticles = (state) => runningOf(state) !== null;

/** Returns whether the worker has work. @param {RunState} state */
export const awaitsWorker = ({ asked, current }) => asked.length > 0 || (current !== null && current.stage !== 'over');

/**
 * Returns whether a run with this outcome has made a surface or found none.
 * @param {Outcome} outcome
 * @param {number} particles
 */
export const tookPlace = (outcome, particles) => outcome === 'complete' || (outcome === 'stopped' && particles > 0);

/** Returns the key by which the inputs of runs are compared. @param {RunRequest} request */
export const inputOf = (request) =>
  JSON.stringify(request.kind === 'sample' ? [request.field, request.settings] : ['relax', request.steps]);

/**
 * Returns the run that repeats the surface on the page with that many more relaxation steps.
 * @param {Shown} shown @param {number} steps
 * @param {Description | null} description  with the ranges of the settings
 * @returns {SampleRequest}
 */
export function relaxed({ request }, steps, description) {
  const settings = { ...request.settings, relax_steps: Number(request.settings.relax_steps) + steps };
  return {
    ...request,
    live: false,
    grow: false,
    fit: false,
    settings: description ? clampSettings(description, settings) : settings,
  };
}

/**
 * Returns the run that is lost with the worker: its current run, or, for a pending report or a relaxation, the run that
 * leads to the same particles again.
 * @param {RunState} state @param {Description | null} description
 * @returns {SampleRequest | null}
 */
export function lostRun(state, description) {
  const { shown, current, waiting } = state;
  const atWorker = waiting ?? runningOf(state)?.request ?? null;
  if (atWorker?.kind === 'sample') return atWorker;
  if (!shown || (!atWorker && shown.reported)) return null;
  return relaxed(shown, atWorker && current?.stage === 'seeding' ? atWorker.steps : 0, description);
}
