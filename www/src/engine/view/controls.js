/**
 * Handles input on the picture: mouse, pen, touch, trackpad and keys move the camera; hovering and tapping select a
 * particle. Only the canvas captures touches; the rest of the page scrolls as usual.
 *
 * @module
 */
import { Pointers, placeOn, zoomAt } from './pointers.js';

/** @import { Place, Stage } from './types.js' */

/**
 * Change in the logarithm of the distance per wheel pixel. A notch of 100 pixels is 14 %; a pinch unit counts about ten
 * times.
 */
const WHEEL_LOG = 0.0013;
const PINCH_LOG = 0.012;
/** Largest pixel count of one event of each kind. */
const MOST_WHEEL_PX = 400;
const MOST_PINCH_PX = 60;
const KEY_TURN_RAD = Math.PI / 24;
const KEY_ZOOM = 1.15;
const KEY_PAN_PX = 40;

/** Turning directions of the arrow keys: right and up. @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * Returns a wheel event's distance in pixels, whatever its unit.
 * @param {{deltaY: number, deltaMode: number}} event
 * @param {number} pagePx
 */
const wheelPixels = ({ deltaY, deltaMode }, pagePx) => deltaY * (deltaMode === 1 ? 16 : deltaMode === 2 ? pagePx : 1);

/**
 * @param {Stage} stage
 * @returns a function that removes all listeners
 */
export function attachControls(stage) {
  const { host, moved } = stage;
  const pointers = new Pointers(stage);
  const hover = hoverOf(stage);
  const off = new AbortController();
  /**
   * @template {keyof HTMLElementEventMap} K
   * @param {K} type @param {(event: HTMLElementEventMap[K]) => void} act
   */
  const on = (type, act) => host.addEventListener(type, act, { signal: off.signal, passive: false });

  on('pointerdown', (event) => {
    if (event.pointerType !== 'mouse' || event.button <= 2) pointers.down(event);
  });
  on('pointermove', (event) => {
    if (pointers.held.has(event.pointerId)) pointers.move(event);
    else if (pointers.held.size === 0 && event.pointerType !== 'touch') hover.at(placeOn(host, event));
  });
  on('pointerup', (event) => pointers.end(event, true));
  on('pointercancel', (event) => pointers.end(event, false));
  on('lostpointercapture', (event) => pointers.end(event, false));
  on('pointerleave', (event) => {
    // A finger also leaves when it is lifted; the particle that it tapped stays selected.
    if (event.pointerType === 'touch') return;
    hover.cancel();
    stage.leave(false);
  });
  // The right button pans. Its context menu would swallow the release event.
  on('contextmenu', (event) => event.preventDefault());
  on('wheel', (event) => {
    event.preventDefault();
    zoomAt(stage, wheelZoom(event, host.clientHeight), placeOn(host, event));
    moved();
  });
  on('keydown', (event) => {
    if (!pressed(event, stage)) return;
    event.preventDefault();
    moved();
  });

  return () => {
    off.abort();
    hover.cancel();
  };
}

/** Limits picking to once per frame, because a pointer may send a thousand events per second. @param {Stage} stage */
function hoverOf({ point }) {
  let frame = 0;
  let last = { x: 0, y: 0 };
  return {
    /** @param {Place} place */
    at(place) {
      last = place;
      if (frame !== 0) return;
      frame = requestAnimationFrame(() => {
        frame = 0;
        point(last.x, last.y, false);
      });
    },
    cancel() {
      cancelAnimationFrame(frame);
      frame = 0;
    },
  };
}

/** Returns the zoom factor of a wheel event. @param {WheelEvent} event @param {number} pagePx */
function wheelZoom(event, pagePx) {
  const pixels = wheelPixels(event, pagePx);
  const within = (/** @type {number} */ most) => Math.min(most, Math.max(-most, pixels));
  // A trackpad pinch arrives as a wheel event with ctrl set, in finer units.
  return Math.exp(-(event.ctrlKey ? within(MOST_PINCH_PX) * PINCH_LOG : within(MOST_WHEEL_PX) * WHEEL_LOG));
}

/** @param {KeyboardEvent} event @param {Stage} stage @returns whether the key is handled */
function pressed(event, { camera, currentView, fit, centre, point }) {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  const arrow = Object.hasOwn(ARROWS, event.key) ? ARROWS[event.key] : null;
  if (arrow) {
    camera.rest();
    const [x, y] = arrow;
    if (event.shiftKey) camera.pan(x * KEY_PAN_PX, -y * KEY_PAN_PX, currentView());
    else camera.orbit(x * KEY_TURN_RAD, -y * KEY_TURN_RAD);
    return true;
  }
  switch (event.key) {
    case '+':
    case '=':
      camera.rest();
      camera.zoom(KEY_ZOOM);
      return true;
    case '-':
    case '_':
      camera.rest();
      camera.zoom(1 / KEY_ZOOM);
      return true;
    case 'Enter': {
      const at = centre();
      if (at) point(at.x, at.y, true);
      return at !== null;
    }
    case 'f':
    case 'F':
    case '0':
      fit();
      return true;
    default:
      return false;
  }
}
