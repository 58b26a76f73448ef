/**
 * Waits until the engine has done what it was asked for.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** @import { Engine, Report } from './types.js' */

/**
 * Resolves with the report once `isOver` holds, or no sampler is there or coming. `isOver` reads
 * signals.
 * @param {Engine} engine @param {() => boolean} isOver
 */
export const once = (engine, isOver) =>
  new Promise((/** @type {(report: Report | null) => void} */ resolve) => {
    let stop = () => {};
    stop = effect(() => {
      // The progress is written anew when the sampler ends. The notice about it may have been
      // dismissed since.
      const isOff = engine.progress.value && engine.debug.isOff();
      if (!isOff && !isOver()) return;
      resolve(engine.report.peek());
      queueMicrotask(() => stop());
    });
  });

/**
 * Returns whether no run is active and the report has arrived, if one is expected.
 * @param {Engine} engine
 */
export const atRest = (engine) =>
  engine.description.value !== null &&
  engine.loading.value === null &&
  !engine.typing.value &&
  !engine.busy.value &&
  engine.progress.value.phase === 'done';

/**
 * Resolves with the report once the sampler is at rest and the picture is up to date. A surface that follows a slider
 * has no report: it is waited for until the slider is let go.
 * @param {Engine} engine
 */
export async function settled(engine) {
  const drawable = () => engine.reveal.value === null && engine.backend.value !== 'starting';
  const report = await once(engine, () => atRest(engine) && !engine.progress.value.live && drawable());
  await engine.debug.still();
  return report;
}
