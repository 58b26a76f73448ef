/**
 * Commands that change how the surface is seen.
 *
 * @module
 */
import { validView } from '../share/view.js';
import { change } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { EngineCommands } from '../types.js'
 */

/**
 * @typedef {Pick<EngineCommands, 'setView' | 'fit' | 'pointOut' | 'turnTo' | 'lookFrom' | 'zoom' |
 *   'orbit' | 'setInsets' | 'pick' | 'dismissHover' | 'project' | 'rayThrough' | 'takeWith' |
 *   'dismissNotice'>} ViewCommands
 */

/** @param {Parts} parts @returns {ViewCommands} */
export function viewCommands({ store, picture }) {
  const { viewer } = picture;
  return {
    setView(patch) {
      const view = validView(/** @type {Record<string, unknown>} */ (patch), store.state.value.view);
      if (patch.camera) viewer.camera.set(view.camera);
      change(store, { view });
      // The box and the axes extend beyond the surface, so the camera moves back to show them.
      if ((patch.box !== undefined || patch.axes !== undefined) && viewer.camera.state.fit) viewer.fit();
      if (store.hover.value && store.hover.value.level > (view.level ?? Infinity)) picture.hover(null, 0, 0);
    },
    fit() {
      viewer.linked = null;
      viewer.fit();
    },
    pointOut(place) {
      store.spot.value = place;
      if (place) viewer.lookAt(place);
    },
    turnTo: (normal) => viewer.turnTo(normal),
    lookFrom: (name) => viewer.lookFrom(name),
    zoom(factor) {
      viewer.camera.zoom(factor);
      viewer.moved();
    },
    orbit(dxRad, dyRad) {
      viewer.camera.rest();
      viewer.camera.orbit(dxRad, dyRad);
      viewer.moved();
    },
    setInsets(insets) {
      // The layout measures whenever a part's size changes, which usually leaves the free area as it was.
      if (JSON.stringify(insets) !== JSON.stringify(viewer.look.insets)) viewer.set({ insets });
    },
    dismissHover: () => picture.hover(null, 0, 0),
    pick: (x, y) => viewer.pick(x, y),
    project: (place) => viewer.project(place),
    rayThrough: (x, y) => viewer.rayThrough(x, y),
    takeWith(take, notices) {
      Object.assign(picture.hand, { take, notices });
    },
    dismissNotice() {
      store.notice.value = null;
    },
  };
}
