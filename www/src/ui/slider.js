/**
 * A slider with a number box: native inputs that share one value. Shift makes the steps ten times finer, and a double
 * click resets the value. The number can be typed and stepped.
 */

import { signal, untracked } from '@preact/signals-core';
import { clamp } from '../engine/vector.js';
import { live, uniqueId } from './dom.js';
import { decimalsOf } from './format.js';
import { numberBox, showNumber } from './number.js';
import { createRange } from './range.js';
import { afterKey, KEYS, nudge, toPlace, toValue } from './scale.js';

/** @import { Scale, Slider, SliderOptions } from './types.js' */

/** Number of positions of the range input: enough for a 4K wide slider with Shift. */
const PLACES = 10000;
/** Width of the thumb in pixels, as in the style sheet. */
const THUMB_PX = 14;

/** @param {SliderOptions} options @returns {Slider} */
export function createSlider(options) {
  const model = new Model(options);
  listenToPointer(model);
  listenToKeys(model);
  const { range, box } = model;
  if (box) listenToBox(model, box);
  model.writeScale();
  model.write();
  /** @param {number} next */
  const set = (next) => {
    if (model.dragging || next === model.value) return;
    model.value = next;
    model.write(document.activeElement === box ? (box ?? undefined) : undefined);
  };
  const { value } = options;
  if (typeof value === 'function') live(range, () => set(value()));
  return {
    range,
    box,
    set,
    setScale(next) {
      model.scale = next;
      model.writeScale();
      model.write();
    },
  };
}

/** The value, its scale, and the inputs that show them. */
class Model {
  #scale;
  #value;

  /** @param {SliderOptions} options */
  constructor(options) {
    this.options = options;
    this.#scale = signal(options.scale);
    this.#value = signal(typeof options.value === 'function' ? untracked(options.value) : options.value);
    this.factor = options.factor ?? 1;
    this.dragging = false;
    const name = options.name;
    this.range = createRange({
      max: () => PLACES,
      at: () => Math.round(toPlace(this.#scale.value, this.#value.value) * PLACES),
      say: () => options.describe(this.#value.value),
      change: (place) => {
        if (!this.dragging) this.take(toValue(this.scale, place / PLACES), true);
      },
      'aria-label': () => {
        // The name belongs to the present surface's parameter, as the scale does.
        void this.#scale.value;
        return this.options.name;
      },
    });
    this.box = options.number === false ? null : numberBox({ name: `${name}, number`, id: uniqueId('number') });
  }

  get scale() {
    return this.#scale.peek();
  }

  set scale(scale) {
    this.#scale.value = scale;
  }

  get value() {
    return this.#value.peek();
  }

  set value(value) {
    this.#value.value = value;
  }

  /** Sets and reports a value. @param {number} next @param {boolean} live */
  take(next, live) {
    if (next === this.value && live) return;
    this.value = next;
    this.write();
    this.options.change(next, live);
  }

  /** Shows the value in the box. @param {Element} [except] an input that is not changed */
  write(except) {
    const { box, scale, value } = this;
    if (box && except !== box) showNumber(box, this.#numberOf(exact(scale, value)));
  }

  writeScale() {
    const { box, scale } = this;
    if (!box) return;
    box.setAttribute('aria-valuemin', this.#numberOf(scale.min));
    box.setAttribute('aria-valuemax', this.#numberOf(scale.max));
  }

  /** Returns a value as the box shows it. @param {number} value */
  #numberOf(value) {
    return String(Number((value * this.factor).toPrecision(12)));
  }
}

/**
 * Rounds to two digits beyond the grid, which keeps values that were typed or set with Shift.
 * @param {Scale} scale
 * @param {number} value
 */
function exact(scale, value) {
  if (scale.integer) return value;
  if (scale.scale === 'log') return Number(value.toPrecision(5));
  return Number(value.toFixed(Math.min(decimalsOf(scale.step) + 2, 12)));
}

/** @param {Model} model @param {HTMLInputElement} input */
function listenToBox(model, input) {
  // A typed number is read once it is complete, because its beginning is another number.
  const read = async () => {
    const { scale, options } = model;
    const text = input.value;
    const number = await (options.read ?? plainNumber)(text);
    // Text typed meanwhile is read by its own event.
    if (input.value !== text) return;
    const typed = number === null ? NaN : number / model.factor;
    // The box accepts any number within the range, not only values on the slider's grid.
    if (Number.isFinite(typed))
      model.take(clamp(scale.integer ? Math.round(typed) : typed, scale.min, scale.max), false);
    model.write();
  };
  input.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') {
      void read();
      // The focus moves to the slider, where the page's shortcuts, such as `,` and `.`, work again.
      model.range.focus({ preventScroll: true });
      return;
    }
    if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
    event.preventDefault();
    model.take(nudge(model.scale, model.value, event.key === 'ArrowUp' ? 1 : -1, event.shiftKey), false);
  });
  input.addEventListener('change', () => void read());
}

/** Reads a plain number; null for any other text. @param {string} text */
const plainNumber = async (text) => (text.trim() === '' || Number.isNaN(Number(text)) ? null : Number(text));

/** Handles dragging, because the native drag has no finer steps. @param {Model} model */
function listenToPointer(model) {
  const { range, options } = model;
  let place = 0;
  let lastX = 0;
  /** @param {PointerEvent} event */
  const placeAt = (event) => {
    const { left, width } = range.getBoundingClientRect();
    return clamp((event.clientX - left - THUMB_PX / 2) / Math.max(1, width - THUMB_PX), 0, 1);
  };
  const end = () => {
    if (!model.dragging) return;
    model.dragging = false;
    options.change(model.value, false);
  };
  range.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || range.disabled) return;
    range.setPointerCapture(event.pointerId);
    model.dragging = true;
    lastX = event.clientX;
    const now = toPlace(model.scale, model.value);
    const { width } = range.getBoundingClientRect();
    // A press on the thumb, or with Shift, keeps the value. A press on the track moves the thumb there.
    const near = Math.abs(placeAt(event) - now) * width < 12;
    place = near || event.shiftKey ? now : placeAt(event);
    if (!near && !event.shiftKey) model.take(toValue(model.scale, place), true);
  });
  range.addEventListener('pointermove', (event) => {
    if (!model.dragging) return;
    // A slider hidden during the drag has no width.
    if (!range.checkVisibility()) return end();
    const width = Math.max(1, range.getBoundingClientRect().width - THUMB_PX);
    const fineness = event.shiftKey ? 10 : 1;
    place += (event.clientX - lastX) / width / fineness;
    lastX = event.clientX;
    model.take(toValue(model.scale, place, fineness), true);
  });
  range.addEventListener('pointerup', end);
  range.addEventListener('pointercancel', end);
  range.addEventListener('lostpointercapture', end);
  range.addEventListener('mousedown', (event) => {
    event.preventDefault();
    range.focus({ preventScroll: true });
  });
  range.addEventListener('touchstart', () => {}, { passive: true });
  range.addEventListener('dblclick', options.reset);
}

/** Handles keys and values set by assistive technology. @param {Model} model */
function listenToKeys(model) {
  const { range, options } = model;
  range.addEventListener('change', () => {
    if (!model.dragging) options.change(model.value, false);
  });
  range.addEventListener('keydown', (event) => {
    const next = afterKey(model.scale, model.value, event);
    if (next === null) return;
    event.preventDefault();
    model.take(next, true);
  });
  range.addEventListener('keyup', (event) => {
    if (event.key in KEYS) options.change(model.value, false);
  });
}
