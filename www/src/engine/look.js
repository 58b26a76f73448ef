/**
 * How the state looks: the theme in force and what the viewer is told to draw.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { changeView } from './store.js';

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
      effect(() => {
        viewer.growing = store.busy.value;
      }),
    ];
  }

  /** Tells the viewer how the state looks now. */
  show() {
    const { store, viewer } = this;
    const { view, bounds } = store.state.value;
    const theme = view.theme === 'auto' ? (this.dark.matches ? 'dark' : 'light') : view.theme;
    store.theme.value = theme;
    const box = bounds ?? store.field.value?.bounds ?? null;
    viewer.set({
      colour: view.colour,
      size: view.size,
      theme,
      box: view.box || store.empty.value ? box : null,
      points: this.points(),
      level: view.level,
    });
    this.runs.sampling.showCurvature(view.colour === 'curvature');
  }

  /** The points of the model on the page, where they are to be drawn. */
  points() {
    const { store } = this;
    const { loader, sampling } = this.runs;
    if (!store.state.value.view.points || store.field.value?.kind !== 'points') return null;
    return loader.client.get(sampling.accepted?.field.points)?.centres ?? null;
  }

  /** What is sampled anew is seen growing, all of it. */
  allLevels() {
    if (this.store.state.value.view.level === null) return;
    changeView(this.store, { level: null });
    this.show();
  }

  close() {
    for (const stop of this.effects) stop();
    this.dark.removeEventListener('change', this.show);
  }
}
