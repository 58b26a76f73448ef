/**
 * Solves the model of an order step by step. The clock and the pause are parameters, so that tests can run the loop on
 * a scripted bundle.
 *
 * @module
 */
import { nextBudget } from '../bundle/budget.js';
import { words } from '../bundle/load.js';

/**
 * @import { WorkerEnv } from '../bundle/types.js'
 * @import { FromPoints, Order, PointsLike } from './types.js'
 */

/** Target duration of a step. A model of a thousand centres then reports its progress about a hundred times. */
const STEP_MS = 30;
const FIRST_BUDGET = 64;
/** Stands for the core's default number of centres; for a built-in model that is all points. */
const USUAL_CENTRES = 0;

/**
 * @param {PointsLike} points
 * @param {Order} order
 * @param {WorkerEnv<FromPoints>} env
 */
export async function solve(points, order, env) {
  const refuse = (/** @type {string} */ message, kind = 'refused') => env.post({ type: 'refused', kind, message });
  env.post({ type: 'progress', label: 'Reading', fraction: 0 });
  let begun;
  if ('model' in order) {
    begun = points.model(order.model, order.centres ?? USUAL_CENTRES);
  } else {
    let bytes;
    try {
      bytes = new Uint8Array(await order.file.arrayBuffer());
    } catch (error) {
      return refuse(`the file cannot be read: ${words(error)}`, 'unreadable');
    }
    begun = points.file(order.file.name, bytes, order.centres ?? USUAL_CENTRES);
  }
  if (!begun.ok) return refuse(begun.error);
  for (let budget = FIRST_BUDGET; ; ) {
    const before = env.nowMs();
    const step = points.step(budget);
    if (!step.ok) return refuse(step.error);
    if (step.done) break;
    budget = nextBudget(budget, env.nowMs() - before, STEP_MS);
    env.post({ type: 'progress', label: step.label, fraction: step.fraction });
    await env.pause();
  }
  const info = points.info();
  if (!info.ok) return refuse(info.error);
  const [field, centres] = [points.field(), points.centres()];
  env.post({ type: 'solved', solved: { field, centres, info: { info: info.info, bounds: info.bounds } } }, [
    field.buffer,
    centres.buffer,
  ]);
}
