/**
 * A handle on the picture: a knob that is dragged along a line in space, or turned. For the keyboard and assistive
 * technology it is a slider.
 */
import { h } from '../../dom.js';

/**
 * @import { Engine, Ray } from '../../../engine/types.js'
 * @import { HandleOptions, Point } from '../types.js'
 */

/** @type {Record<string, number>} */
const PRESSES = { ArrowRight: 1, ArrowLeft: -1, ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 };

/** @param {Engine} engine @param {HTMLElement} stage @param {HandleOptions} options */
export function createHandle(engine, stage, { name, kind, grab, drag, drop, cancel, press }) {
  const told = { role: 'slider', tabindex: 0, 'aria-label': name, 'aria-valuenow': 0 };
  const knob = h('div', { class: `handle ${kind}`, ...(press ? told : { tabindex: -1, 'aria-hidden': 'true' }) });
  /** @type {number | null} */
  let held = null;
  /** Offset of the pointer from the centre of the knob, constant during a drag. */
  let grip = { x: 0, y: 0 };
  /** @param {PointerEvent} event @returns {Ray} */
  const rayOf = (event) => {
    const { left, top } = stage.getBoundingClientRect();
    return engine.rayThrough(event.clientX - left - grip.x, event.clientY - top - grip.y);
  };
  const end = (/** @type {() => void} */ then) => {
    if (held === null) return;
    held = null;
    delete knob.dataset.held;
    then();
  };
  knob.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || held !== null) return;
    event.preventDefault();
    knob.focus({ preventScroll: true });
    held = event.pointerId;
    knob.dataset.held = '';
    knob.setPointerCapture(event.pointerId);
    const { left, top, width, height } = knob.getBoundingClientRect();
    grip = { x: event.clientX - left - width / 2, y: event.clientY - top - height / 2 };
    grab(rayOf(event));
  });
  knob.addEventListener('pointermove', (event) => {
    if (event.pointerId === held) drag(rayOf(event), event.shiftKey);
  });
  for (const type of /** @type {const} */ (['pointerup', 'pointercancel', 'lostpointercapture']))
    knob.addEventListener(type, () => end(drop));
  knob.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && held !== null) {
      event.stopPropagation();
      end(cancel);
      return;
    }
    const presses = PRESSES[event.key];
    if (!press || !presses || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    press(presses, event.shiftKey);
  });
  return {
    knob,
    /** Places the knob in the picture, or hides it. @param {Point | null} spot */
    put(spot) {
      knob.hidden = spot === null;
      if (spot) knob.style.transform = `translate(${spot.x.toFixed(1)}px, ${spot.y.toFixed(1)}px)`;
    },
    /**
     * Reports the value to assistive technology.
     * @param {number} now
     * @param {number} min
     * @param {number} max
     * @param {string} text
     */
    tell(now, min, max, text) {
      const round = (/** @type {number} */ v) => String(Number(v.toPrecision(6)));
      knob.setAttribute('aria-valuenow', round(now));
      knob.setAttribute('aria-valuemin', round(Math.min(now, min)));
      knob.setAttribute('aria-valuemax', round(Math.max(now, max)));
      knob.setAttribute('aria-valuetext', text);
    },
  };
}
