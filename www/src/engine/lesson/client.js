/**
 * The page's side of the lesson: starts runs of the paper's algorithms in a worker of their own and asks for their
 * events.
 *
 * ```js
 * const lesson = new LessonClient();
 * const progress = await lesson.start({ formula, parameters, bounds }, { radius: 0.05 });
 * const [first] = await lesson.ask('chapters', { first: 0 });
 * const events = await lesson.ask('events', { first: first.first_event, count: first.events });
 * const particles = await lesson.ask('seek', { event: first.first_event + 12 });
 * ```
 *
 * @module
 */
import { RequestWorker } from '../bundle/requests.js';

/**
 * @import {
 *   Fault, FromLesson, LessonClientOptions, LessonProgress, LessonSettings, Questions, Surface, ToLesson, WorkerLike,
 * } from './types.js'
 */

/**
 * Why the client rejects a promise. `refused`: the formula or a setting is not accepted, with the core's `fault`;
 * `given_up`: another run has begun, or the client was closed; `crashed`: the bundle stopped on an error; `bundle`: it
 * did not load.
 * @typedef {'refused' | 'given_up' | 'crashed' | 'bundle'} LessonErrorKind
 */

export class LessonError extends Error {
  /** @param {LessonErrorKind} kind @param {string} message @param {Fault | null} [fault] */
  constructor(kind, message, fault = null) {
    super(message);
    this.name = 'LessonError';
    this.kind = kind;
    this.fault = fault;
  }
}

/** Starts the lesson's worker, which loads its bundle at the first request. @returns {WorkerLike} */
const spawnLesson = () => new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'lesson' });

export class LessonClient {
  #onProgress;

  /** @type {RequestWorker<ToLesson, FromLesson>} */
  #worker;

  /** Number of the current run. */
  #run = 0;

  /** @param {LessonClientOptions} [options] */
  constructor({ spawn = spawnLesson, onProgress = () => {} } = {}) {
    this.#onProgress = onProgress;
    this.#worker = new RequestWorker({
      spawn,
      onMessage: (message) => this.#receive(message),
      onFail: (message) => this.#fail('bundle', message || 'the lesson did not load'),
    });
  }

  /**
   * Begins a run, which continues until it ends or is stopped. The previous run is cancelled. Meanwhile questions can
   * be asked about the part that exists.
   * @param {Surface} surface
   * @param {Partial<LessonSettings>} settings  missing ones have defaults, except `radius`
   * @returns {Promise<LessonProgress>}
   */
  start(surface, settings) {
    this.#worker.requests.refuseAll(new LessonError('given_up', 'another run has begun'));
    return this.#worker.ask((id) => {
      this.#run = id;
      return { type: 'start', id, surface, settings };
    });
  }

  /** Stops the current run; its promise resolves. */
  stop() {
    this.#worker.post({ type: 'stop' });
  }

  /**
   * Asks about the current run.
   * @template {keyof Questions} K
   * @param {K} about @param {Questions[K]['ask']} ask
   * @returns {Promise<Questions[K]['answer']>}
   */
  ask(about, ask) {
    return this.#worker.ask((id) => /** @type {ToLesson} */ ({ type: 'ask', id, about, ask }));
  }

  /** Ends the worker and frees its memory. The next run starts another one. */
  close() {
    this.#worker.end(new LessonError('given_up', 'the lesson was closed'));
  }

  /** @param {FromLesson} message */
  #receive(message) {
    const { requests } = this.#worker;
    switch (message.type) {
      case 'progress':
        if (message.id === this.#run) this.#onProgress(message.progress);
        break;
      case 'ended':
        requests.answer(message.id, message.progress);
        break;
      case 'answer':
        requests.answer(message.id, message.answer);
        break;
      case 'refused':
        requests.refuse(message.id, new LessonError('refused', message.error.message, message.error));
        break;
      case 'crashed':
        this.#fail('crashed', `the lesson stopped on an error: ${message.message}`);
        break;
      case 'failed':
        this.#fail('bundle', message.message);
        break;
      default:
    }
  }

  /** Ends a worker that failed. @param {'crashed' | 'bundle'} kind @param {string} message */
  #fail(kind, message) {
    this.#worker.end(new LessonError(kind, message));
  }
}

/** The kind of a run's error, or null for other errors. @param {unknown} error */
export const kindOf = (error) => (error instanceof LessonError ? error.kind : null);
