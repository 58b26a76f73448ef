/**
 * Derives the appearance from the state: the effective theme and the options of the viewer.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { changeView } from './store.js';

/**
 * Largest number of particles at which the surface to come is drawn. They are joined to a mesh for it, which takes about 0.1 s.
 */
const MOST_TO_COME = 200_000;

export class Look {
  /**
   * @param {object} parts
   * @param {import('./store.js').Store} parts.store
   * @param {import('./view/viewer.js').Viewer} parts.viewer
   * @param {import('./runs.js').Runs} parts.runs
   */
  constructor({ store, viewer, runs }) {
    this.store = store;
    this.viewer = viewer;
    this.runs = runs;
    this.dark = matchMedia('(prefers-color-scheme: dark)');
    this.show = this.show.bind(this);
    this.dark.addEventListener('change', this.show);
    this.effects = [
      effect(() => {
        const field = store.field.value;
        if (field) viewer.setBounds(field.bounds);
        if (store.empty.value || field) queueMicrotask(this.show);
      }),
      // Whether there can be a mesh depends on the back end.
      effect(() => {
        if (store.backend.value !== 'starting') queueMicrotask(this.show);
      }),
      effect(() => {
        viewer.growing = store.busy.value;
      }),
    ];
  }

  /** Passes the present appearance to the viewer. */
  show() {
    const { store, viewer } = this;
    const { view, bounds, plane } = store.state.value;
    const theme = view.theme === 'auto' ? (this.dark.matches ? 'dark' : 'light') : view.theme;
    store.theme.value = theme;
    const box = bounds ?? store.field.value?.bounds ?? null;
    // Where there is no surface, its box is shown, unless there is no surface anywhere.
    const isMissed = store.empty.value && store.field.value?.reach !== 'nowhere';
    const isGhostly = view.ghost || this.isToCome();
    viewer.set({
      colour: view.colour,
      size: view.size,
      draw: view.draw,
      faces: view.faces,
      edges: view.edges,
      marks: view.marks,
      ghost: isGhostly,
      theme,
      box: view.box || isMissed ? box : null,
      axes: view.axes,
      plane,
      points: this.points(),
      level: view.level,
      step: view.step,
    });
    const { sampling } = this.runs;
    sampling.showCurvature(view.colour === 'curvature');
    // Without a graphics device there are discs.
    const { value: backend } = store.backend;
    sampling.showMesh((view.draw === 'mesh' || isGhostly) && (backend === 'webgpu' || backend === 'webgl2'));
  }

  /**
   * Returns whether the surface is still to come, because only a part of the run is shown. Then it is drawn faintly. The mesh over
   * all particles stands for it: it is exact where the particles will be, and there is no second way of drawing.
   */
  isToCome() {
    const { level, follow } = this.store.state.value.view;
    return (level !== null || follow !== null) && this.viewer.columns.count <= MOST_TO_COME;
  }

  /** Returns the points of the model on the page, or null if they are not drawn. */
  points() {
    const { store } = this;
    const { loader, sampling } = this.runs;
    if (!store.state.value.view.points || store.field.value?.kind !== 'points') return null;
    return loader.client.get(sampling.accepted?.field.points)?.centres ?? null;
  }

  /** Shows all generation levels again, because a new surface is shown as it grows. */
  allLevels() {
    const { level, step } = this.store.state.value.view;
    if (level === null && step === null) return;
    changeView(this.store, { level: null, step: null });
    this.show();
  }

  close() {
    for (const stop of this.effects) stop();
    this.dark.removeEventListener('change', this.show);
  }
}
