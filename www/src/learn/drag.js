/** What is dragged beside the ranges: a number in a sentence, and a drawing. */
import { clamp } from '../engine/vector.js';
import { h, queryAll } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { afterKey, toPlace, toValue } from '../ui/scale.js';
import { rangePlaces } from './parts.js';
import { pin } from './pinned.js';
import { TOLERANCES, toleranceWords } from './whatifs.js';

/** @import { Point } from '../figures/types.js' */
/** @import { NumberOptions } from './types.js' */

/** A number goes through its whole range on so many pixels. */
const RANGE_PX = 240;

/**
 * A number in a sentence: a slider that is dragged sideways, or turned by its keys.
 * @param {NumberOptions} about
 */
export function createNumber({ name, scale, value, say, change, stage }) {
  /** Where the drag is; null without one. @type {{ place: number, x: number } | null} */
  let drag = null;
  const end = () => {
    drag = null;
  };
  /** @param {number} to */
  function set(to) {
    const host = stage ? stage() : element.closest('.stage, .bench');
    if (host instanceof HTMLElement) pin(element, host, drag !== null);
    change(to);
  }
  const element = h(
    'span',
    {
      class: 'number',
      role: 'slider',
      tabindex: 0,
      'aria-label': name,
      'aria-valuemin': scale.min,
      'aria-valuemax': scale.max,
      'aria-valuenow': value,
      'aria-valuetext': () => say(value()),
      title: `${name}: drag it sideways, or press the arrow keys`,
      on: {
        keydown(event) {
          const next = afterKey(scale, value(), event);
          if (next === null) return;
          event.preventDefault();
          set(next);
        },
        pointerdown(event) {
          if (event.button !== 0) return;
          event.preventDefault();
          element.focus({ preventScroll: true });
          element.setPointerCapture(event.pointerId);
          drag = { place: toPlace(scale, value()), x: event.clientX };
        },
        pointermove(event) {
          if (!drag) return;
          const fineness = event.shiftKey ? 10 : 1;
          drag.place = clamp(drag.place + (event.clientX - drag.x) / RANGE_PX / fineness, 0, 1);
          drag.x = event.clientX;
          set(toValue(scale, drag.place, fineness));
        },
        pointerup: end,
        pointercancel: end,
        lostpointercapture: end,
      },
    },
    () => say(value()),
  );
  return element;
}

/**
 * The tolerance as a number in a sentence.
 * @param {Pick<NumberOptions, 'value' | 'change' | 'stage'>} about
 */
export const createTolerance = ({ change, ...about }) =>
  createNumber({
    ...about,
    name: 'Tolerance',
    scale: TOLERANCES,
    say: toleranceWords,
    change: (to) => change(Number(to.toPrecision(3))),
  });

/**
 * Makes the numbers of the text that name a figure handles of its first range. A number with `data-times` is so many
 * times the range's value.
 * @param {HTMLElement} stage  with the live figure
 */
export function mountNumbers(stage) {
  const input = stage.querySelector('input[type="range"]');
  const place = input && rangePlaces.get(input);
  if (!(input instanceof HTMLInputElement) || !place) return;
  for (const words of queryAll(document, `[data-number="${stage.dataset.figure}"]`)) {
    const times = Number(words.dataset.times ?? 1);
    const scale = { min: 0, max: times * Number(input.max), step: times };
    const element = createNumber({
      name: words.title,
      scale,
      value: () => times * place.value,
      say: formatCount,
      stage: () => stage,
      change(value) {
        input.valueAsNumber = value / times;
        input.dispatchEvent(new Event('input', { bubbles: true }));
      },
    });
    words.replaceWith(element);
  }
}

/**
 * Has a drawing dragged. It may be drawn anew meanwhile.
 * @param {HTMLElement} host  holds the drawing
 * @param {(at: Point, isFirst: boolean) => void} take  a place in the units of the drawing, y upwards
 */
export function dragIn(host, take) {
  let isOn = false;
  /** @param {PointerEvent} event @param {boolean} isFirst */
  const tell = ({ clientX, clientY }, isFirst) => {
    const matrix = host.querySelector('svg')?.getScreenCTM();
    if (!matrix) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
    take([x, -y], isFirst);
  };
  const end = () => {
    isOn = false;
  };
  host.classList.add('dragged');
  host.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    host.setPointerCapture(event.pointerId);
    isOn = true;
    tell(event, true);
  });
  host.addEventListener('pointermove', (event) => {
    if (isOn) tell(event, false);
  });
  for (const kind of /** @type {const} */ (['pointerup', 'pointercancel', 'lostpointercapture']))
    host.addEventListener(kind, end);
}
