/**
 * Solves the model of an order step by step. The clock and the pause are parameters, so that tests can run the loop on
 * a scripted bundle.
 *
 * @module
 */
import { words } from '../bundle/load.js';
import { inSlices } from '../bundle/slices.js';

/**
 * @import { WorkerEnv } from '../bundle/types.js'
 * @import { FromPoints, Order, PointsLike } from './types.js'
 */

/** Target duration of a step. A model of a thousand centres then reports its progress about a hundred times. */
const STEP_MS = 30;
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
  const slice = (/** @type {number} */ budget) => {
    const step = points.step(budget);
    if (!step.ok || step.done) return step;
    env.post({ type: 'progress', label: step.label, fraction: step.fraction });
    return undefined;
  };
  const { made: last } = await inSlices(slice, env, { targetMs: STEP_MS });
  if (last?.ok === false) return refuse(last.error);
  const info = points.info();
  if (!info.ok) return refuse(info.error);
  const [field, centres] = [points.field(), points.centres()];
  env.post({ type: 'solved', solved: { field, centres, info: { info: info.info, bounds: info.bounds } } }, [
    field.buffer,
    centres.buffer,
  ]);
}
