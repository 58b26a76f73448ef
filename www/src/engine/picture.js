/**
 * Builds the picture on the page: the viewer, its input handlers, and their connection to the signals.
 *
 * @module
 */

import { batch } from '@preact/signals-core';
import { NO_PARENT } from './core-numbers.js';
import { CAMERA_MS } from './debug.js';
import { changeView } from './store.js';
import { triple } from './vector.js';
import { attachControls } from './view/controls.js';
import { Viewer } from './view/viewer.js';

/**
 * @import { Picture, PictureOptions } from './parts.js'
 * @import { Store } from './store.js'
 * @import { Columns } from './types.js'
 * @import { Device } from './view/types.js'
 */

/**
 * @param {PictureOptions} parts
 * @returns {Picture}
 */
export function createPicture({ host, store, columns, first }) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let cameraTimer;
  host.tabIndex = Math.max(host.tabIndex, 0);

  const viewer = new Viewer(
    { host, columns, look: store.state.value.view, first },
    {
      ...deviceEvents(store, () => void viewer.keeper.retry()),
      onLegend(legend) {
        const { colour, value } = store.state.peek().view;
        store.legend.value = colour === 'value' ? { ...legend, title: value } : legend;
      },
      onReveal(reveal) {
        store.reveal.value = reveal;
      },
      onFrame() {
        store.frame.value += 1;
      },
      onCamera() {
        cameraTimer ??= setTimeout(() => {
          cameraTimer = undefined;
          changeView(store, { camera: viewer.camera.state });
        }, CAMERA_MS);
      },
    },
  );

  /** @type {Picture['hover']} */
  const hover = (index, x, y, tapped = false) => {
    if (index !== null) store.hover.value = { ...particle(columns, index), x, y, tapped };
    else if (store.hover.value) store.hover.value = null;
    if (viewer.look.highlight !== (index ?? -1)) viewer.set({ highlight: index ?? -1 });
  };

  /** @type {Picture['hand']} */
  const hand = { take: () => null, notices: () => false };
  const detach = attachControls({
    host,
    camera: viewer.camera,
    currentView: () => viewer.currentView(),
    moved: () => viewer.moved(),
    fit: () => viewer.fit(),
    point(x, y, tapped) {
      if (hand.notices({ x, y }, tapped)) return;
      if (!tapped && store.hover.value?.tapped) return;
      const held = tapped ? hand.take({ x, y }, false) : null;
      // Enter presses the middle of the picture. A pointer's press was taken already.
      if (held) return held.drop();
      const index = viewer.pick(x, y);
      const { measured } = store.state.value.view;
      // While a distance is measured, a press chooses an end of it.
      if (index !== null || tapped || store.hover.value) hover(index, x, y, tapped && !measured);
      if (tapped && index !== null && measured) changeView(store, { measured: withEnd(measured, index) });
      if (tapped) store.spot.value = null;
    },
    centre: () => viewer.project(viewer.camera.state.target),
    leave(pressed) {
      if (pressed || !store.hover.value?.tapped) hover(null, 0, 0);
    },
    take: (at, shift) => hand.take(at, shift),
  });

  return {
    viewer,
    hover,
    hand,
    close() {
      clearTimeout(cameraTimer);
      detach();
      viewer.destroy();
    },
  };
}

/**
 * Returns the handlers that report the state of the graphics device to the user.
 * @param {Store} store
 * @param {() => void} retry  opens the best kind again
 */
function deviceEvents(store, retry) {
  return {
    onDevice(/** @type {Device} */ { kind, renderer }) {
      batch(() => {
        store.backend.value = kind;
        store.adapter.value = renderer.adapter();
        if (store.notice.value?.id === 'device-lost') {
          store.notice.value = { id: 'device-lost', kind: 'info', text: 'The graphics device was lost and is back.' };
        }
      });
    },
    onLost(/** @type {string} */ kind, /** @type {string} */ message) {
      store.notice.value = {
        id: 'device-lost',
        kind: 'warn',
        text: 'The graphics device was lost and is being opened again.',
        details: `${kind}: ${message}`,
      };
    },
    onFallback(/** @type {string} */ kind, /** @type {string} */ message, isLate = false) {
      const isLast = kind === 'canvas2d';
      // Missing kinds are normal at the start; later fallbacks are reported to the user.
      if (store.backend.value === 'starting' && !isLast && !isLate) return;
      store.notice.value = {
        id: 'fallback',
        kind: isLast ? 'error' : 'warn',
        text: isLast
          ? 'There is no picture: none of the ways of drawing could be started.'
          : `Drawing with ${kind === 'webgpu' ? 'WebGPU' : 'WebGL2'} failed; the picture is drawn another way.`,
        details: `${kind}: ${message}`,
        action: { label: 'Try again', run: retry },
      };
    },
  };
}

/**
 * Adds an end to a measured distance; a third one begins a new distance.
 * @param {readonly number[]} measured
 * @param {number} index
 */
const withEnd = (measured, index) => (measured.length === 1 && measured[0] !== index ? [measured[0], index] : [index]);

/** Returns the attributes of one particle that the hover card shows. @param {Columns} columns @param {number} index */
function particle(columns, index) {
  return {
    index,
    level: columns.levels[index],
    parent: columns.parents[index] === NO_PARENT ? null : columns.parents[index],
    curve: columns.curveAt(index),
    position: triple(columns.shown, index),
    normal: triple(columns.normals, index),
    radius: columns.radii[index],
    residual: columns.residual?.[index] ?? null,
    valence: columns.valence?.[index] ?? null,
    nearest: columns.nearest?.[index] ?? null,
  };
}
