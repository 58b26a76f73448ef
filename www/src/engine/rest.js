/**
 * Waits until the engine has done its work.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** @import { Engine, Report } from './types.js' */

/**
 * Resolves with the report once `isOver` holds, or there is no sampler and none is coming. `isOver` reads signals.
 * @param {Engine} engine @param {() => boolean} isOver
 */
export const once = (engine, isOver) =>
  new Promise((/** @type {(report: Report | null) => void} */ resolve) => {
    let stop = () => {};
    stop = effect(() => {
      // The progress changes when the sampler ends. The notice may already have been dismissed.
      const isOff = engine.progress.value && engine.debug.isOff();
      if (!isOff && !isOver()) return;
      resolve(engine.report.peek());
      queueMicrotask(() => stop());
    });
  });

/**
 * Whether no run is active and an expected report has arrived.
 * @param {Engine} engine
 */
export const atRest = (engine) =>
  engine.description.value !== null &&
  engine.loading.value === null &&
  engine.trial.value !== 'typing' &&
  engine.status.value === 'rest' &&
  engine.progress.value.phase === 'done';

/**
 * Resolves with the report once the sampler is at rest and the picture is up to date. While a surface follows a slider
 * it has no report, so this waits until the slider is released.
 * @param {Engine} engine
 */
export async function settled(engine) {
  const drawable = () => engine.reveal.value === null && engine.backend.value !== 'starting';
  const report = await once(engine, () => atRest(engine) && !engine.progress.value.live && drawable());
  await engine.debug.still();
  return report;
}
