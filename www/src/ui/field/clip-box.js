/** The controls of the clip box, one row per axis, and the line about a surface that it cuts. */
import { computed, effect } from '@preact/signals-core';
import { cutOf, enlarge } from '../box.js';
import { fill, h } from '../dom.js';
import { formatSignificant } from '../format.js';

/** @import { Bounds, Engine } from '../../engine/types.js' */

const AXES = /** @type {const} */ (['x', 'y', 'z']);
/** Step of the number boxes, as a share of the box's side. It is rounded to a power of ten. */
const STEP_SHARE = 0.02;

/** @param {Engine} engine */
export function createClipBox(engine) {
  const bounds = computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);
  const drawn = computed(() => engine.state.value.view.box);
  const own = computed(() => engine.state.value.bounds !== null || engine.state.value.settings.box_mode === 'fixed');
  /** Whether the surface has a box of its own, as those of the gallery and of points have. */
  const kept = computed(() => engine.field.value?.surface !== null || engine.field.value?.kind === 'points');

  const summary = h('span', { class: 'quiet range' });
  const inputs = AXES.map((axis, i) =>
    /** @type {const} */ (['min', 'max']).map((end) => {
      const input = h('input', {
        type: 'number',
        class: 'box',
        step: 'any',
        inputmode: 'decimal',
        'aria-label': `${axis} ${end === 'min' ? 'from' : 'to'}`,
        on: {
          change: () => commit(input.valueAsNumber),
          keydown: (event) => {
            if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
            event.preventDefault();
            const now = bounds.peek();
            if (!now) return;
            const step =
              10 ** Math.round(Math.log10(Math.max(1e-6, (now.max[i] - now.min[i]) * STEP_SHARE))) /
              (event.shiftKey ? 10 : 1);
            commit(Number((now[end][i] + (event.key === 'ArrowUp' ? step : -step)).toPrecision(12)));
          },
        },
      });
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
      return input;
    }),
  );

  /** @param {Bounds} now */
  function write(now) {
    inputs.forEach(([low, high], i) => {
      low.value = String(Number(now.min[i].toPrecision(6)));
      high.value = String(Number(now.max[i].toPrecision(6)));
    });
  }

  const show = h('input', { type: 'checkbox', on: { change: () => engine.setView({ box: show.checked }) } });
  const reset = h(
    'button',
    {
      type: 'button',
      class: () => (own.value ? 'button plain small' : 'button plain small invisible'),
      on: { click: () => engine.fitBox() },
    },
    () => (kept.value ? 'Reset' : 'Fit'),
  );
  const details = h(
    'details',
    { class: 'section clip' },
    h('summary', { class: 'section-head' }, h('h2', null, 'Clip box'), summary),
    h(
      'div',
      { class: 'clip-grid' },
      AXES.flatMap((axis, i) => [
        h('var', null, axis),
        inputs[i][0],
        h('span', { class: 'quiet', 'aria-hidden': 'true' }, 'to'),
        inputs[i][1],
      ]),
    ),
    h('div', { class: 'section-head clip-foot' }, h('label', { class: 'check' }, show, 'Draw the box'), reset),
  );
  effect(() => {
    const now = bounds.value;
    if (!now) return;
    write(now);
    const size = now.max.map((high, i) => formatSignificant(high - now.min[i], 3)).join(' × ');
    summary.textContent = engine.field.value?.reach === 'bounded' ? `fits · ${size}` : size;
  });
  effect(() => {
    show.checked = drawn.value;
  });
  return [createCut(engine), details];
}

/** Creates the line about a surface that the box cuts, with what to do. @param {Engine} engine */
function createCut(engine) {
  const line = h('div', { class: 'section cut', role: 'status' });
  // During a run the line of the previous one stays.
  let last = cutOf(engine.report.peek());
  const cut = computed(() => {
    if (engine.empty.value) last = null;
    else if (engine.report.value) last = cutOf(engine.report.value);
    return last;
  });
  effect(() => {
    const now = cut.value;
    line.hidden = now === null;
    if (!now) return fill(line);
    const action = (/** @type {string} */ label, /** @type {() => void} */ act) =>
      h('button', { type: 'button', class: 'button small', on: { click: act } }, label);
    fill(
      line,
      h('p', null, now.text),
      h('div', { class: 'repairs' }, [
        action('Enlarge', () => enlarge(engine)),
        now.canFit ? action('Fit', () => engine.fitBox()) : null,
      ]),
    );
  });
  return line;
}
