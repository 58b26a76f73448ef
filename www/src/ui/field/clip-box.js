/** The controls of the clip box, one row per axis. */
import { computed, effect } from '@preact/signals-core';
import { h } from '../dom.js';
import { formatSignificant } from '../format.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').Bounds} Bounds */

const AXES = /** @type {const} */ (['x', 'y', 'z']);
/** Step of the number boxes, as a share of the box's side. It is rounded to a power of ten. */
const STEP_SHARE = 0.02;

/** @param {Engine} engine */
export function createClipBox(engine) {
  const bounds = computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);
  const drawn = computed(() => engine.state.value.view.box);
  const own = computed(() => engine.state.value.bounds !== null);

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
          keydown: (/** @type {KeyboardEvent} */ event) => {
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
    { type: 'button', class: 'button plain small', on: { click: () => engine.setBounds(null) } },
    'Reset',
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
    summary.textContent = now.max.map((high, i) => formatSignificant(high - now.min[i], 3)).join(' × ');
  });
  effect(() => {
    show.checked = drawn.value;
  });
  effect(() => {
    reset.classList.toggle('invisible', !own.value);
  });
  return details;
}
