/**
 * Hands on the picture: mouse, pen, touch, trackpad and keys move the camera; hover and tap choose a particle.
 *
 * A drag ends with its pointer, whatever happens to it: release, cancel, lost capture. Only the canvas keeps touches to itself;
 * the rest of the page scrolls as it always does.
 *
 * @module
 */

/**
 * @typedef {import('./camera.js').Camera} Camera
 * @typedef {import('./camera.js').View} View
 */
/**
 * @typedef {object} Stage
 * @property {HTMLElement} host
 * @property {Camera} camera
 * @property {() => View} currentView
 * @property {() => void} moved
 * @property {() => void} fit
 * @property {(x: number, y: number, tapped: boolean) => void} point  the pointer rests on, or tapped, this place
 * @property {() => void} leave
 */

/** A drag across the whole shorter side turns the surface by this much. */
const TURN_PER_SIDE_RAD = Math.PI * 0.9;
/** A press that moves less than this, and lasts less long, is a tap. */
const TAP_PX = 4;
const TAP_MS = 400;
/** The speed of a throw is measured over this last stretch of the drag. */
const THROW_MS = 80;
/** Wheel units to the logarithm of the distance: a notch of 100 pixels is 14 %, a pinch unit about ten times as much. */
const WHEEL_LOG = 0.0013;
const PINCH_LOG = 0.012;
const KEY_TURN_RAD = Math.PI / 24;
const KEY_ZOOM = 1.15;
const KEY_PAN_PX = 40;

/** Pixels of a wheel event, whatever unit it came in. @param {{deltaY: number, deltaMode: number}} event @param {number} pagePx */
export const wheelPixels = ({ deltaY, deltaMode }, pagePx) =>
  deltaY * (deltaMode === 1 ? 16 : deltaMode === 2 ? pagePx : 1);

/**
 * @param {Stage} stage
 * @returns {() => void} takes every listener off again
 */
export function attachControls({ host, camera, currentView, moved, fit, point, leave }) {
  /** @type {Map<number, {x: number, y: number}>} */
  const held = new Map();
  let panning = false;
  /** @type {{x: number, y: number, atMs: number, still: boolean} | null} */
  let press = null;
  /** @type {{dx: number, dy: number, atMs: number}[]} */
  let trail = [];
  let hoverFrame = 0;
  let lastHover = { x: 0, y: 0 };
  const off = new AbortController();
  const { signal } = off;

  /** @param {{clientX: number, clientY: number}} event */
  const place = (event) => {
    const box = host.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const radPerPx = () => TURN_PER_SIDE_RAD / Math.max(1, Math.min(host.clientWidth, host.clientHeight));
  /** @param {number} factor @param {{x: number, y: number}} at */
  const zoomAt = (factor, at) => {
    camera.zoom(factor, {
      view: currentView(),
      xPx: at.x,
      yPx: at.y,
      widthPx: host.clientWidth,
      heightPx: host.clientHeight,
    });
  };

  host.addEventListener(
    'pointerdown',
    (event) => {
      if (event.pointerType === 'mouse' && event.button > 2) return;
      camera.rest();
      const at = place(event);
      held.set(event.pointerId, at);
      try {
        host.setPointerCapture(event.pointerId);
      } catch {
        // The pointer is gone already; its end will still be heard.
      }
      panning = event.button !== 0 || event.shiftKey;
      trail = [];
      press = held.size === 1 ? { ...at, atMs: event.timeStamp, still: true } : null;
      leave();
    },
    { signal },
  );

  host.addEventListener(
    'pointermove',
    (event) => {
      const before = held.get(event.pointerId);
      const at = place(event);
      if (!before) {
        if (held.size > 0 || event.pointerType === 'touch') return;
        // One look per frame: the pointer may report a thousand times a second.
        if (hoverFrame === 0) {
          hoverFrame = requestAnimationFrame(() => {
            hoverFrame = 0;
            point(lastHover.x, lastHover.y, false);
          });
        }
        lastHover = at;
        return;
      }
      if (press?.still && Math.hypot(at.x - press.x, at.y - press.y) > TAP_PX) press.still = false;
      const dx = at.x - before.x;
      const dy = at.y - before.y;
      if (held.size === 1) {
        if (press?.still) return;
        if (panning) camera.pan(dx, dy, currentView());
        else {
          camera.orbit(dx * radPerPx(), dy * radPerPx());
          trail.push({ dx, dy, atMs: event.timeStamp });
          if (trail.length > 64) trail.shift();
        }
      } else if (held.size === 2) {
        const other = [...held].find(([id]) => id !== event.pointerId)?.[1] ?? at;
        const spanBefore = Math.hypot(before.x - other.x, before.y - other.y);
        const span = Math.hypot(at.x - other.x, at.y - other.y);
        camera.pan(dx / 2, dy / 2, currentView());
        if (spanBefore > 8 && span > 8) zoomAt(span / spanBefore, { x: (at.x + other.x) / 2, y: (at.y + other.y) / 2 });
      }
      held.set(event.pointerId, at);
      moved();
    },
    { signal },
  );

  /** @param {PointerEvent} event @param {boolean} released  by the hand, not taken away */
  const end = (event, released) => {
    if (!held.delete(event.pointerId)) return;
    if (held.size > 0) {
      // The finger that stays goes on from where it is.
      trail = [];
      press = null;
      panning = false;
      return;
    }
    const at = place(event);
    if (released && press?.still && event.timeStamp - press.atMs < TAP_MS && event.button === 0) {
      point(at.x, at.y, true);
    } else if (released && !panning) {
      const recent = trail.filter((step) => event.timeStamp - step.atMs < THROW_MS);
      const since = recent.length ? event.timeStamp - recent[0].atMs : 0;
      if (since > 8) {
        const perS = (radPerPx() * 1000) / since;
        camera.fling(recent.reduce((sum, s) => sum + s.dx, 0) * perS, recent.reduce((sum, s) => sum + s.dy, 0) * perS);
      }
    }
    press = null;
    trail = [];
    moved();
  };
  host.addEventListener('pointerup', (event) => end(event, true), { signal });
  host.addEventListener('pointercancel', (event) => end(event, false), { signal });
  host.addEventListener('lostpointercapture', (event) => end(event, false), { signal });
  host.addEventListener(
    'pointerleave',
    (event) => {
      // A finger leaves whenever it is lifted: what it tapped stays chosen.
      if (event.pointerType === 'touch') return;
      cancelAnimationFrame(hoverFrame);
      hoverFrame = 0;
      leave();
    },
    { signal },
  );
  // The right button pans; its menu would swallow the release.
  host.addEventListener('contextmenu', (event) => event.preventDefault(), { signal });

  host.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const pixels = wheelPixels(event, host.clientHeight);
      // A trackpad pinch arrives as a wheel with ctrl, in finer units.
      const log = event.ctrlKey
        ? Math.min(60, Math.max(-60, pixels)) * PINCH_LOG
        : Math.min(400, Math.max(-400, pixels)) * WHEEL_LOG;
      zoomAt(Math.exp(-log), place(event));
      moved();
    },
    { signal, passive: false },
  );

  host.addEventListener(
    'keydown',
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const view = currentView();
      const turn = (/** @type {number} */ x, /** @type {number} */ y) => {
        if (event.shiftKey) camera.pan(x * KEY_PAN_PX, -y * KEY_PAN_PX, view);
        else camera.orbit(x * KEY_TURN_RAD, -y * KEY_TURN_RAD);
      };
      camera.rest();
      switch (event.key) {
        case 'ArrowLeft':
          turn(-1, 0);
          break;
        case 'ArrowRight':
          turn(1, 0);
          break;
        case 'ArrowUp':
          turn(0, 1);
          break;
        case 'ArrowDown':
          turn(0, -1);
          break;
        case '+':
        case '=':
          camera.zoom(KEY_ZOOM);
          break;
        case '-':
        case '_':
          camera.zoom(1 / KEY_ZOOM);
          break;
        case 'f':
        case 'F':
        case '0':
          fit();
          break;
        default:
          return;
      }
      event.preventDefault();
      moved();
    },
    { signal },
  );

  return () => {
    off.abort();
    cancelAnimationFrame(hoverFrame);
  };
}
