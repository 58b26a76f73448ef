/**
 * A slider with a number box: native inputs, one value. Shift makes ten times finer steps, a double click resets, the
 * number can be typed and stepped.
 */
import { h, setAttribute, uniqueId } from './dom.js';
import { decimalsOf } from './format.js';
import { clamp, nudge, snap, toPlace, toValue } from './scale.js';

/** @typedef {import('./scale.js').Scale} Scale */
/**
 * @typedef {object} SliderOptions
 * @property {string} name what assistive technology calls it
 * @property {Scale} scale
 * @property {number} value
 * @property {(value: number) => string} describe the value in words, with its unit
 * @property {(value: number, live: boolean) => void} change `live` while the hand is still on it
 * @property {() => void} reset
 * @property {boolean} [number] false: no number box
 * @property {number} [factor] what the box shows, over the value: 100 for per cent
 */
/**
 * @typedef {object} Slider
 * @property {HTMLInputElement} range
 * @property {HTMLInputElement | null} box
 * @property {(value: number) => void} set shows a value without reporting it
 * @property {(scale: Scale) => void} setScale
 */

const KEYS = /** @type {Record<string, number>} */ ({
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
});
/** Places of the range input: fine enough for a 4K wide slider under shift. */
const PLACES = 10000;

/** @param {SliderOptions} options @returns {Slider} */
export function createSlider(options) {
  let { scale, value } = options;
  const factor = options.factor ?? 1;
  let dragging = false;
  const range = h('input', {
    type: 'range',
    class: 'slider',
    min: 0,
    max: PLACES,
    step: 1,
    'aria-label': options.name,
  });
  const box = options.number === false ? null : createBox();

  function createBox() {
    const input = h('input', {
      type: 'number',
      class: 'box',
      id: uniqueId('number'),
      'aria-label': `${options.name}, number`,
      inputmode: 'decimal',
    });
    // A typed number counts once it is finished: half a number is another number.
    const read = () => {
      const typed = input.valueAsNumber / factor;
      // The box takes any number within the range, not only the slider's grid.
      if (!Number.isNaN(typed)) take(clamp(scale.integer ? Math.round(typed) : typed, scale.min, scale.max), false);
      write();
    };
    input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') {
        // The number is finished. On the slider beside it the page's own keys work again, `,` and `.` among them.
        read();
        range.focus({ preventScroll: true });
        return;
      }
      if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
      event.preventDefault();
      take(nudge(scale, value, event.key === 'ArrowUp' ? 1 : -1, event.shiftKey), false);
    });
    input.addEventListener('change', read);
    return input;
  }

  /** @param {number} next @param {boolean} live */
  function take(next, live) {
    if (next === value && live) return;
    value = next;
    write();
    options.change(value, live);
  }

  /** @param {Element} [except] */
  function write(except) {
    const place = toPlace(scale, value);
    range.valueAsNumber = Math.round(place * PLACES);
    range.style.setProperty('--place', place.toFixed(4));
    range.setAttribute('aria-valuetext', options.describe(value));
    if (box && except !== box) {
      // Two digits beyond the grid, for values made under shift or typed.
      const exact = scale.integer
        ? value
        : scale.scale === 'log'
          ? Number(value.toPrecision(5))
          : Number(value.toFixed(Math.min(decimalsOf(scale.step) + 2, 12)));
      box.value = String(Number((exact * factor).toPrecision(12)));
    }
  }

  function writeScale() {
    setAttribute(range, 'aria-label', options.name);
    if (!box) return;
    box.min = String(Number((scale.min * factor).toPrecision(12)));
    box.max = String(Number((scale.max * factor).toPrecision(12)));
    box.step = 'any';
  }

  // Dragging by hand: the native drag knows no finer steps.
  let place = 0;
  let lastX = 0;
  /** @param {PointerEvent} event */
  const placeAt = (event) => {
    const { left, width } = range.getBoundingClientRect();
    const thumb = 14;
    return clamp((event.clientX - left - thumb / 2) / Math.max(1, width - thumb), 0, 1);
  };
  range.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || range.disabled) return;
    range.setPointerCapture(event.pointerId);
    dragging = true;
    lastX = event.clientX;
    const now = toPlace(scale, value);
    const { width } = range.getBoundingClientRect();
    // A press on the thumb, or with shift, moves nothing; a press on the track jumps there.
    const near = Math.abs(placeAt(event) - now) * width < 12;
    place = near || event.shiftKey ? now : placeAt(event);
    if (!near && !event.shiftKey) take(toValue(scale, place), true);
  });
  range.addEventListener('pointermove', (event) => {
    if (!dragging) return;
    // A slider that was hidden under the hand has no places to go to.
    if (!range.checkVisibility()) return end();
    const width = Math.max(1, range.getBoundingClientRect().width - 14);
    const fineness = event.shiftKey ? 10 : 1;
    place += (event.clientX - lastX) / width / fineness;
    lastX = event.clientX;
    take(toValue(scale, place, fineness), true);
  });
  const end = () => {
    if (!dragging) return;
    dragging = false;
    options.change(value, false);
  };
  range.addEventListener('pointerup', end);
  range.addEventListener('pointercancel', end);
  range.addEventListener('lostpointercapture', end);
  range.addEventListener('mousedown', (event) => {
    event.preventDefault();
    range.focus({ preventScroll: true });
  });
  range.addEventListener('touchstart', () => {}, { passive: true });
  // Assistive technology sets the value directly.
  range.addEventListener('input', () => {
    if (dragging) write();
    else take(toValue(scale, range.valueAsNumber / PLACES), true);
  });
  range.addEventListener('change', () => {
    if (!dragging) options.change(value, false);
  });
  range.addEventListener('keydown', (event) => {
    const presses = KEYS[event.key];
    if (presses === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const next = Number.isFinite(presses)
      ? nudge(scale, value, presses, event.shiftKey)
      : snap(scale, presses > 0 ? scale.max : scale.min);
    take(next, true);
  });
  range.addEventListener('keyup', (event) => {
    if (KEYS[event.key] !== undefined) options.change(value, false);
  });
  range.addEventListener('dblclick', options.reset);

  writeScale();
  write();
  return {
    range,
    box,
    set(next) {
      if (dragging || next === value) return;
      value = next;
      write(document.activeElement === box ? (box ?? undefined) : undefined);
    },
    setScale(next) {
      scale = next;
      writeScale();
      write();
    },
  };
}
