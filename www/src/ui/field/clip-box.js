/** The controls of the clip box, one row per axis, and the message about a surface that it cuts. */
import { computed } from '@preact/signals-core';
import { cutOf, enlarge, wholePeriods } from '../box.js';
import { button } from '../button.js';
import { h, live } from '../dom.js';
import { formatSignificant } from '../format.js';
import { numberBox, showNumber } from '../number.js';

/** @import { Bounds, Engine, ReadonlySignal } from '../../engine/types.js' */

const AXES = /** @type {const} */ (['x', 'y', 'z']);
/** Step of the number boxes, as a share of the box's side. It is rounded to a power of ten. */
const STEP_SHARE = 0.02;
/** The offered numbers of whole periods. */
const TIMES = [1, 2, 3];

/** @param {Engine} engine */
export function createClipBox(engine) {
  const bounds = computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);
  const own = computed(() => engine.state.value.bounds !== null || engine.state.value.settings.box_mode === 'fixed');
  /** Whether the surface comes with a box, as those of the gallery and of points do. */
  const kept = computed(() => engine.field.value?.surface !== null || engine.field.value?.model !== null);
  const size = () => {
    const size = bounds.value?.max
      .map((high, i) => formatSignificant(high - (bounds.value?.min[i] ?? 0), 3))
      .join(' × ');
    return size && engine.field.value?.reach === 'bounded' ? `fits · ${size}` : size;
  };
  const details = h(
    'details',
    { class: 'section clip' },
    h('summary', { class: 'section-head' }, h('h2', null, 'Clip box'), h('span', { class: 'quiet range' }, size)),
    h(
      'div',
      { class: 'clip-grid' },
      AXES.map((axis, i) => [
        h('var', null, axis),
        createNumber(engine, bounds, { i, end: 'min', name: `${axis} from` }),
        h('span', { class: 'quiet', 'aria-hidden': 'true' }, 'to'),
        createNumber(engine, bounds, { i, end: 'max', name: `${axis} to` }),
      ]),
    ),
    createPeriods(engine, bounds),
    h(
      'div',
      { class: 'section-head clip-foot' },
      h(
        'label',
        { class: 'check' },
        h('input', {
          type: 'checkbox',
          prop: { checked: () => engine.state.value.view.box },
          on: { change: ({ currentTarget }) => engine.setView({ box: currentTarget.checked }) },
        }),
        'Draw the box',
      ),
      button(
        { class: () => (own.value ? 'plain small' : 'plain small invisible'), press: () => engine.fitBox() },
        () => (kept.value ? 'Reset' : 'Fit'),
      ),
    ),
  );
  return [createCut(engine), details];
}

/**
 * Creates the buttons for a box of whole periods, for a periodic surface.
 * @param {Engine} engine @param {ReadonlySignal<Bounds | null>} bounds
 */
function createPeriods(engine, bounds) {
  const periods = computed(() => engine.field.value?.periods ?? []);
  const boxOf = (/** @type {Bounds | null} */ now, /** @type {number} */ times) =>
    now && wholePeriods(now, periods.value, times);
  const isNow = (/** @type {number} */ times) =>
    JSON.stringify(boxOf(bounds.value, times)) === JSON.stringify(bounds.value);
  const press = (/** @type {number} */ times) => {
    const next = boxOf(bounds.peek(), times);
    if (next) engine.setBounds(next);
  };
  return h(
    'div',
    { class: 'clip-periods', role: 'group', 'aria-label': 'Whole periods', hidden: () => !periods.value.some(Boolean) },
    h('span', null, 'Whole periods'),
    TIMES.map((times) =>
      button({ class: 'small', 'aria-pressed': () => String(isNow(times)), press: () => press(times) }, `${times} ×`),
    ),
  );
}

/**
 * Creates the number box of one side of the box.
 * @param {Engine} engine
 * @param {ReadonlySignal<Bounds | null>} bounds
 * @param {{ i: number, end: 'min' | 'max', name: string }} side  `i`: number of the axis
 */
function createNumber(engine, bounds, { i, end, name }) {
  const input = numberBox({ name });
  input.addEventListener('change', () => void engine.readNumber(input.value).then((value) => commit(value ?? NaN)));
  input.addEventListener('keydown', (event) => {
    if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
    event.preventDefault();
    const now = bounds.peek();
    if (!now) return;
    const step =
      10 ** Math.round(Math.log10(Math.max(1e-6, (now.max[i] - now.min[i]) * STEP_SHARE))) / (event.shiftKey ? 10 : 1);
    commit(Number((now[end][i] + (event.key === 'ArrowUp' ? step : -step)).toPrecision(12)));
  });
  /** @param {Bounds} now */
  function write(now) {
    showNumber(input, String(Number(now[end][i].toPrecision(6))));
  }
  /** @param {number} value */
  function commit(value) {
    const now = bounds.peek();
    if (!now) return;
    /** @type {Bounds} */
    const next = { min: [...now.min], max: [...now.max] };
    next[end][i] = value;
    if (Number.isFinite(value) && next.min[i] < next.max[i]) engine.setBounds(next);
    else write(now);
  }
  live(input, () => bounds.value && write(bounds.value));
  return input;
}

/** Creates the message about a surface that the box cuts, with the remedy. @param {Engine} engine */
function createCut(engine) {
  // During a run the previous message stays.
  let last = cutOf(engine.report.peek(), engine.enlargement());
  const cut = computed(() => {
    if (engine.result.value === 'none') last = null;
    else if (engine.report.value) last = cutOf(engine.report.value, engine.enlargement());
    return last;
  });
  return h('div', { class: 'section cut', role: 'status', hidden: () => cut.value === null }, () => {
    const now = cut.value;
    return (
      now && [
        h('p', null, now.text),
        h(
          'div',
          { class: 'repairs' },
          now.canEnlarge && button({ class: 'small', press: () => enlarge(engine) }, 'Enlarge'),
          now.canFit && button({ class: 'small', press: () => engine.fitBox() }, 'Fit'),
        ),
      ]
    );
  });
}
