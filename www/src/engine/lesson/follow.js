/**
 * Runs lessons in the worker: continues the current run in slices and answers questions in between. The bundle's class,
 * the clock and the pause are parameters, so that tests can use it without a worker.
 *
 * @module
 */
import { inSlices } from '../bundle/slices.js';

/**
 * @import { Lesson } from '../../wasm/lesson/lesson.js'
 * @import { WorkerEnv } from '../bundle/types.js'
 * @import { FromLesson, Particles, ToLesson } from './types.js'
 */

/** Target duration of a slice, so that questions are answered soon. */
const SLICE_MS = 20;

/**
 * @param {Lesson} lesson
 * @param {WorkerEnv<FromLesson>} env
 */
export function follow(lesson, env) {
  /** Number of the current run; 0 for none. */
  let present = 0;
  /** Whether the current run is to stop. */
  let stops = false;

  /** @param {Extract<ToLesson, {type: 'start'}>} order */
  async function start({ id, surface, settings }) {
    present = id;
    stops = false;
    const answer =
      'system' in surface
        ? lesson.start_points(surface.system, surface.pulls, surface.bounds, settings)
        : lesson.start(surface, settings);
    if (!answer.ok) return env.post({ type: 'refused', id, error: answer.error });
    /** @type {{progress: ReturnType<typeof step> | null}} */
    const last = { progress: null };
    const slice = (/** @type {number} */ budget) => {
      const progress = step(lesson, budget);
      last.progress = progress;
      if (progress.is_done) return true;
      env.post({ type: 'progress', id, progress });
      return undefined;
    };
    // Another run that has begun meanwhile sends its own messages.
    const interrupt = () => (present === id ? (stops ? 'stopped' : null) : 'replaced');
    const { why } = await inSlices(slice, { ...env, interrupt }, { targetMs: SLICE_MS });
    if (why !== 'replaced' && last.progress) env.post({ type: 'ended', id, progress: last.progress });
  }

  return {
    /** @param {ToLesson} message */
    async receive(message) {
      switch (message.type) {
        case 'start':
          await start(message);
          break;
        case 'stop':
          stops = true;
          break;
        case 'ask':
          env.post({ type: 'answer', id: message.id, answer: answer(lesson, message) });
          break;
        default:
      }
    },
  };
}

/** @param {Lesson} lesson @param {number} units */
function step(lesson, units) {
  const progress = lesson.step(units);
  if (!progress) throw new Error('No run was begun.');
  return progress;
}

/** @param {Lesson} lesson @param {number} at  the event that was sought @returns {Particles} */
const particles = (lesson, at) => ({
  at,
  positions: lesson.positions(),
  normals: lesson.normals(),
  radii: lesson.radii(),
  levels: lesson.levels(),
  parents: lesson.parents(),
  fronts: lesson.fronts(),
  slots: lesson.slots(),
  done: lesson.done(),
});

/** @param {Lesson} lesson @param {Extract<ToLesson, {type: 'ask'}>} question */
function answer(lesson, question) {
  switch (question.about) {
    case 'chapters':
      return lesson.chapters(question.ask.first);
    case 'events':
      return lesson.events(question.ask.first, question.ask.count);
    case 'seek':
      return particles(lesson, lesson.seek(Math.min(question.ask.event, 0xffff_ffff)));
    case 'life':
      return lesson.life(question.ask.particle);
    case 'section': {
      const { centre, right, up, half, cells } = question.ask;
      return lesson.section(Float64Array.from(centre), Float64Array.from(right), Float64Array.from(up), half, cells);
    }
    case 'newton':
      return lesson.newton(Float64Array.from(question.ask.start), question.ask.reach);
  }
}
