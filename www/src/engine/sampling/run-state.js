/**
 * Where the runs stand: a record that only {@link reduce} makes anew, and what follows from it. Pure functions: the client tells
 * what has happened and acts on the outcome.
 *
 * @module
 */
import { clampSettings } from '../share/state.js';

/**
 * @typedef {import('../types.js').Bounds} Bounds
 * @typedef {import('../types.js').Description} Description
 * @typedef {import('../types.js').FieldRequest} FieldRequest
 * @typedef {import('../types.js').Settings} Settings
 */
/**
 * A wish for a run. `settings` are complete. `fit` lets the camera follow when the run is done; `confirmed` skips the question
 * whether so many particles are wanted; `restoring` makes the surface that stays on the page whole, while the state asks for
 * another that cannot be had.
 * @typedef {object} SampleRequest
 * @property {'sample'} kind
 * @property {FieldRequest} field
 * @property {Settings} settings
 * @property {boolean} grow
 * @property {boolean} live
 * @property {boolean} fit
 * @property {boolean} [confirmed]
 * @property {boolean} [restoring]
 * @property {boolean} [coarse]
 */
/** @typedef {{kind: 'relax', of: number, steps: number, live: false, grow: true, fit: false, restoring?: false}} RelaxRequest */
/** @typedef {SampleRequest | RelaxRequest} RunRequest */
/**
 * How far a run has come. `seeding`: none of its particles is on the page; `growing`: some are; `measuring`: all are, and the
 * report is to come; `over`: nothing more is to come.
 * @typedef {'seeding' | 'growing' | 'measuring' | 'over'} Stage
 */
/**
 * A job at the worker. `bounds` is the clip box of its field, once that is accepted.
 * @typedef {{id: number, request: RunRequest, bounds: Bounds | null, stage: Stage, sinceMs: number}} Run
 */
/** @typedef {{request: SampleRequest, reported: boolean}} Shown */
/**
 * @typedef {object} RunState
 * @property {readonly Run[]} asked  jobs of whose field the worker has not spoken, in their order
 * @property {Run | null} current  the job whose messages count: the last whose field was accepted
 * @property {number} held  the job whose particles the worker holds, 0 for none
 * @property {SampleRequest | null} accepted  the last sampling that the core accepted
 * @property {Shown | null} shown  the sampling whose particles are on the page, and whether their report is too
 * @property {boolean} astray  whether the surface on the page is not the one that was asked for last
 * @property {number} stoppedUpTo  the last job that a stop was sent after: none up to it goes on
 * @property {string} crashedInput  what the worker last failed on, as of {@link inputOf}
 */
/**
 * What can happen. `particles`: the first of the current run have arrived; `lost`: the worker is gone, and all that was under
 * way with it; `crashed`: it failed on `input`, which is sent `again` or given up.
 * @typedef {{type: 'sent', id: number, request: RunRequest, nowMs: number}
 *   | {type: 'accepted', id: number, bounds: Bounds}
 *   | {type: 'refused', id: number}
 *   | {type: 'particles', description: Description | null}
 *   | {type: 'done', outcome: import('./protocol.js').Outcome, particles: number, reportFollows: boolean}
 *   | {type: 'reported'}
 *   | {type: 'stopped', lastId: number}
 *   | {type: 'lost'}
 *   | {type: 'crashed', input: string, again: boolean}
 *   | {type: 'revived'}} RunEvent
 */

/** @type {RunState} */
export const IDLE = Object.freeze({
  asked: [],
  current: null,
  held: 0,
  accepted: null,
  shown: null,
  astray: false,
  stoppedUpTo: 0,
  crashedInput: '',
});

/** @param {RunState} state @param {RunEvent} event @returns {RunState} */
export function reduce(state, event) {
  switch (event.type) {
    case 'sent': {
      const { id, request, nowMs } = event;
      /** @type {Run} */
      const run = { id, request, bounds: null, stage: 'seeding', sinceMs: nowMs };
      // A relaxation has no field to be accepted.
      return request.kind === 'relax' ? { ...state, current: run } : { ...state, asked: [...state.asked, run] };
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
        accepted: request,
        astray: request.restoring === true && state.astray,
      };
    }
    case 'refused':
      return { ...state, asked: after(state.asked, event.id) };
    case 'particles':
      return firstParticles(state, event.description);
    case 'done':
      return done(state, event);
    case 'reported':
      return { ...atStage(state, 'over'), shown: state.shown && { ...state.shown, reported: true } };
    case 'stopped':
      return { ...state, stoppedUpTo: event.lastId };
    case 'lost':
      return { ...state, asked: [], current: null, held: 0 };
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
  if (request.kind === 'sample') return { ...next, shown: { request, reported: false } };
  return { ...next, shown: shown && { request: relaxed(shown, request.steps, description), reported: false } };
}

/** @param {RunState} state @param {Extract<RunEvent, {type: 'done'}>} event @returns {RunState} */
function done(state, { outcome, particles, reportFollows }) {
  const { current, shown, accepted } = state;
  if (!current) return state;
  const next = atStage(state, reportFollows ? 'measuring' : 'over');
  if (tookPlace(outcome, particles)) {
    return particles > 0 ? { ...next, held: current.id } : { ...next, held: 0, shown: null };
  }
  // The surface before stays; a run of the same that was stopped at once leaves it what it was.
  const wanted = current.request.kind === 'sample' ? current.request : accepted;
  const same = JSON.stringify(shown?.request.field) === JSON.stringify(wanted?.field);
  return { ...next, astray: current.request.restoring === true || outcome !== 'stopped' || !same };
}

/** @param {RunState} state @param {Stage} stage @returns {RunState} */
const atStage = (state, stage) => ({ ...state, current: state.current && { ...state.current, stage } });

/** Jobs are asked about in their order: the worker never looked at those before that are still there. @param {readonly Run[]} asked @param {number} id */
const after = (asked, id) => asked.filter((run) => run.id > id);

/** The job with this id, if the worker has not spoken of it. @param {RunState} state @param {number} id */
export const askedRun = ({ asked }, id) => asked.find((run) => run.id === id);

/** Whether the page waits for particles. @param {RunState} state */
export const awaitsParticles = ({ asked, current }) =>
  asked.length > 0 || current?.stage === 'seeding' || current?.stage === 'growing';

/** Whether the worker has something to do. @param {RunState} state */
export const awaitsWorker = ({ asked, current }) => asked.length > 0 || (current !== null && current.stage !== 'over');

/** Whether a run that ended so made a surface, or found that there is none. @param {import('./protocol.js').Outcome} outcome @param {number} particles */
export const tookPlace = (outcome, particles) => outcome === 'complete' || (outcome === 'stopped' && particles > 0);

/** The id under which a run's input is compared with another's. @param {RunRequest} request */
export const inputOf = (request) =>
  JSON.stringify(request.kind === 'sample' ? [request.field, request.settings] : ['relax', request.steps]);

/**
 * The run that makes what is on the page anew, relaxed by so many steps more.
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
 * What is lost when the worker goes: the run it was at; where only a report is owed, or a relaxation whose particles are gone
 * with it, the run that ends with it.
 * @param {RunState} state @param {RunRequest | null} atWorker @param {Description | null} description
 * @returns {SampleRequest | null}
 */
export function lostRun({ shown, current }, atWorker, description) {
  if (atWorker?.kind === 'sample') return atWorker;
  if (!shown || (!atWorker && shown.reported)) return null;
  return relaxed(shown, atWorker && current?.stage === 'seeding' ? atWorker.steps : 0, description);
}
