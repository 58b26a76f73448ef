/** Dragging apart from ranges: a number in a sentence, and a drawing. */
import { clamp } from '../engine/vector.js';
import { h, queryAll } from '../ui/dom.js';
import { afterKey, toPlace, toValue } from '../ui/scale.js';
import { TOLERANCES, toleranceWords } from './knobs.js';
import { pin } from './pinned.js';

/** @import { Point } from '../figures/types.js' */
/** @import { NumberOptions } from './types.js' */

/** Pixels over which a number goes through its whole range. */
const RANGE_PX = 240;

/**
 * A number in a sentence that acts as a slider: dragged sideways, or changed by keys.
 * @param {NumberOptions} about
 */
export function createNumber({ name, scale, value, say, change, stage }) {
  /** State of the drag; null without one. @type {{ place: number, x: number } | null} */
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
 * The options of the tolerance as a number in a sentence.
 * @param {Pick<NumberOptions, 'value' | 'change' | 'stage'>} about  @returns {NumberOptions}
 */
export const toleranceNumber = ({ change, ...about }) => ({
  ...about,
  name: 'Tolerance',
  scale: TOLERANCES,
  say: toleranceWords,
  change: (to) => change(Number(to.toPrecision(3))),
});

/**
 * Turns numbers of the text with this name in `data-number` into handles for a number of a figure. With `data-times`,
 * the number in the text is a multiple of it.
 * @param {string} name @param {NumberOptions} about  its accessible name is the title of the number in the text, if any
 */
export function offerNumber(name, { scale, value, change, ...about }) {
  for (const words of queryAll(document, `[data-number="${name}"]`)) {
    const times = Number(words.dataset.times ?? 1);
    words.replaceWith(
      createNumber({
        ...about,
        name: words.title || about.name,
        scale: { min: times * scale.min, max: times * scale.max, step: times * scale.step },
        value: () => times * value(),
        change: (to) => change(to / times),
      }),
    );
  }
}

/**
 * Makes a drawing draggable. It may be redrawn meanwhile.
 * @param {HTMLElement} host  holds the drawing
 * @param {(at: Point, isFirst: boolean) => void} take  gets a point in the drawing's units, y upwards
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
