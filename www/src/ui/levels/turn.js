/** Turns the picture so that the seed of the front is visible, since it is often on the far side. */
import { reducedMotion } from '../dom.js';
import { clamp } from '../scale.js';
import { facing } from './facing.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

const TURN_MS = 500;

/** @param {Engine} engine */
export function turnToSeed(engine) {
  const from = engine.state.peek().view.camera;
  const to = facing(from, engine.columns.normals.subarray(0, 3));
  if (!to) return;
  const way = [to.yaw - from.yaw, to.pitch - from.pitch];
  const start = performance.now();
  let done = 0;
  let held = false;
  // Any input by the user stops the rotation.
  addEventListener(
    'pointerdown',
    () => {
      held = true;
    },
    { once: true, capture: true },
  );
  const turn = () => {
    if (held) return;
    const t = reducedMotion() ? 1 : clamp((performance.now() - start) / TURN_MS, 0, 1);
    const eased = t * t * (3 - 2 * t);
    engine.orbit(-way[0] * (eased - done), way[1] * (eased - done));
    done = eased;
    if (t < 1) requestAnimationFrame(turn);
  };
  turn();
}
