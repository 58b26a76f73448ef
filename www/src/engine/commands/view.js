/**
 * Commands that change how the surface is seen.
 *
 * @module
 */
import { validView } from '../share/state.js';
import { change } from '../store.js';

/** @typedef {Pick<import('../types.js').EngineCommands, 'setView' | 'fit' | 'zoom' | 'orbit' | 'setInsets' | 'pick' | 'dismissNotice'>} ViewCommands */

/** @param {import('../index.js').Parts} parts @returns {ViewCommands} */
export function viewCommands({ store, picture, look }) {
  const { viewer } = picture;
  return {
    setView(patch) {
      const view = validView(/** @type {Record<string, unknown>} */ (patch), store.state.value.view);
      if (patch.camera) viewer.camera.set(view.camera);
      change(store, { view });
      look.show();
      if (store.hover.value && store.hover.value.level > (view.level ?? Infinity)) picture.hover(null, 0, 0);
    },
    fit: () => viewer.fit(),
    zoom(factor) {
      viewer.camera.zoom(factor);
      viewer.moved();
    },
    orbit(dxRad, dyRad) {
      viewer.camera.rest();
      viewer.camera.orbit(dxRad, dyRad);
      viewer.moved();
    },
    setInsets: (insets) => viewer.set({ insets }),
    pick: (x, y) => viewer.pick(x, y),
    dismissNotice() {
      store.notice.value = null;
    },
  };
}
