/**
 * Keeps the picture's appearance in step with the state: the effective theme and the viewer's options.
 *
 * @module
 */
import { computed, effect, signal, untracked } from '@preact/signals-core';
import { isBareModel } from './pulls.js';
import { seenOf } from './view/style.js';

/**
 * @import { ModelLoader } from './points/loader.js'
 * @import { Sampler } from './sampling/sampler.js'
 * @import { Store } from './store.js'
 * @import { Viewer } from './view/viewer.js'
 */

/**
 * @param {{ store: Store, viewer: Viewer, sampler: Sampler, loader: ModelLoader }} parts
 * @returns a function that ends it
 */
export function keepLook({ store, viewer, sampler, loader }) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const isDark = signal(system.matches);
  const follow = () => {
    isDark.value = system.matches;
  };
  system.addEventListener('change', follow);

  // If the surface misses the box, the box is drawn so that it can be moved; if no surface exists anywhere, it is not.
  const isMissed = computed(
    () =>
      store.result.value === 'none' &&
      store.field.value?.reach !== 'nowhere' &&
      store.progress.value.stop_reason !== 'constant',
  );

  /** Returns the points of the current model, or null if they are not drawn. */
  function points() {
    const { view, pulls } = store.state.value;
    // The points belong to the surface before it is pulled, cut or joined.
    if (!view.points || !isBareModel(store.field.value) || pulls.length > 0) return null;
    return loader.client.get(sampler.accepted?.field.points)?.centres ?? null;
  }

  function look() {
    const { view, bounds, plane } = store.state.value;
    const theme = /** @type {'light' | 'dark'} */ (
      view.theme === 'auto' ? (isDark.value ? 'dark' : 'light') : view.theme
    );
    const field = store.field.value;
    return {
      ...seenOf(view),
      theme,
      box: view.box || isMissed.value ? (bounds ?? field?.bounds ?? null) : null,
      plane,
      points: points(),
    };
  }

  const ends = [
    effect(() => {
      const field = store.field.value;
      if (field) viewer.setBounds(field.bounds);
    }),
    effect(() => {
      viewer.grow(store.status.value === 'sampling');
    }),
    effect(() => {
      const now = look();
      untracked(() => {
        store.theme.value = now.theme;
        viewer.set(now);
        sampler.client.wish('curvature', now.colour === 'curvature');
        sampler.client.wish('mesh', now.draw === 'mesh');
        sampler.client.wishValue(now.colour === 'value' ? store.state.value.view.value : '');
      });
    }),
    () => system.removeEventListener('change', follow),
  ];
  return () => {
    for (const end of ends) end();
  };
}
