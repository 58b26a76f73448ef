/**
 * The engine of the page: samples in a worker, draws on a canvas, keeps the state. The interface reads its signals and
 * calls its commands; it needs nothing else of this folder but the types.
 *
 * @module
 */
import { signal } from '@preact/signals-core';

/** @typedef {import('./types.js').Engine} Engine */

/**
 * @param {{canvasHost: HTMLElement}} options  `canvasHost` is filled with a canvas of its own size
 * @returns {Engine}
 */
export function createEngine({ canvasHost }) {
  void canvasHost;
  /** @type {import('./types.js').State} */
  const initial = {
    v: 1, surface: 'ellipsoid', formula: '', parameters: {}, declared: [], bounds: null, settings: {},
    view: { colour: 'level', size: 0.92, theme: 'auto', box: false, camera: { target: [0, 0, 0], distance: 4, yaw: 0.6, pitch: 0.4, fit: true } },
  };
  return {
    state: signal(initial),
    description: signal(null),
    field: signal(null),
    fieldError: signal(null),
    fieldPreview: signal(null),
    progress: signal({
      run: 0, live: false, phase: 'idle', particles: 0, level: 0, relax_step: 0, relax_steps: 0, evaluations: 0, fraction: 0,
      stop_reason: null, message: null, radius: 0, moved: false,
    }),
    report: signal(null),
    timing: signal(null),
    backend: signal('starting'),
    adapter: signal(''),
    notice: signal(null),
    hover: signal(null),
    legend: signal(null),
    busy: signal(false),
    partial: signal(false),
    empty: signal(false),
    lastDrag: signal(null),
    theme: signal('light'),
    setSurface() {}, setFormula() {}, setParameter() {}, resetParameter() {}, declareParameter() {}, setBounds() {},
    setSetting() {}, resetSetting() {}, run() {}, stop() {}, generateOnly() {}, relax() {}, setView() {}, fit() {}, zoom() {},
    orbit() {},
    shareUrl: async () => location.href,
    loadUrl: async () => {},
    savePng: async () => new Blob(),
    exportFile: async () => new Blob(),
    dismissNotice() {},
    pick: () => null,
    destroy() {},
  };
}
