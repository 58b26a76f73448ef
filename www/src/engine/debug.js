/**
 * Commands and counters of an engine for tests: losing the device, waiting for the picture, reading counters.
 *
 * @module
 */

/**
 * @import { Parts } from './parts.js'
 * @import { EngineDebug } from './types.js'
 */

/** Delay between a movement of the camera and its entry in the state. */
export const CAMERA_MS = 120;

/** Returns the painter, if it draws. @param {Parts['picture']['viewer']} viewer */
const painterOf = ({ keeper: { device } }) => (device && 'work' in device.renderer ? device.renderer : null);

/** @param {Parts} parts @returns {EngineDebug} */
export function createDebug({ store, picture: { viewer }, sampler }) {
  return {
    loseDevice(reason = 'unknown') {
      const { device } = viewer.keeper;
      if (reason === 'unknown') viewer.keeper.lost('unknown: asked for from the console');
      else device?.renderer.destroy();
    },
    stale(id) {
      const progress = /** @type {const} */ ({ phase: 'generation', particles: 123_456_789 });
      sampler.receive({ type: 'progress', id, progress: { ...store.progress.value, ...progress } });
    },
    still: () =>
      new Promise((resolve) => {
        const look = () => {
          if ((viewer.frames.asked !== 0 || viewer.reveal.active || viewer.isWaiting) && !viewer.frames.isHidden)
            requestAnimationFrame(look);
          else setTimeout(resolve, CAMERA_MS + 10);
        };
        // The check is deferred, because a signal can change during a frame, before that frame requests the next one.
        setTimeout(look);
      }),
    isOff: () => sampler.client.isOff,
    counts: () => ({
      frames: viewer.frames.drawn,
      uploads: viewer.upload.writes,
      opened: viewer.keeper.opened,
      restarts: sampler.client.restarts.length,
      stale: sampler.stale,
      dimmed: viewer.dimmer.on,
      work: painterOf(viewer)?.work ?? 0,
    }),
  };
}
