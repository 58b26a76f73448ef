/** Controls and charts shared by several figures. */

import { signal } from '@preact/signals-core';
import { clamp } from '../engine/vector.js';
import { button } from '../ui/button.js';
import { draw, floorOf, footOf, scaleOf } from '../ui/chart.js';
import { h, reducedMotion, uniqueId } from '../ui/dom.js';
import { icon } from '../ui/icons.js';
import { createRange } from '../ui/range.js';
import { createSelect } from '../ui/select.js';

/** @import { Signal } from '@preact/signals-core' */
/** @import { Children, Drawn } from '../ui/types.js' */

/** @import { RangeRowOptions, SelectRowOptions } from './types.js' */

/**
 * A range with a name and its value in words.
 * @param {RangeRowOptions} about
 */
export function createRangeRow({ name, max, value = 0, say, change }) {
  const id = uniqueId('range');
  /** The value of the range. */
  const place = signal(value);
  const set = (/** @type {number} */ to) => {
    place.value = to;
    change(to);
  };
  const input = createRange({
    id,
    max: () => (typeof max === 'number' ? max : max()),
    at: () => place.value,
    say: () => say(place.value),
    change: set,
  });
  const output = h('output', { class: 'range-value', for: id }, () => say(place.value));
  return {
    element: h('div', { class: 'range-row' }, h('label', { for: id }, name), input, output),
    input,
    place,
    get: () => place.peek(),
    set,
  };
}

/**
 * A button that moves a range from beginning to end; with reduced motion, at once.
 * @param {ReturnType<typeof createRangeRow>} range @param {{ label: string, totalMs: number | (() => number) }} about
 */
export function createPlay(range, { label, totalMs }) {
  const max = () => Number(range.input.max);
  const timer = signal(0);
  function stop() {
    clearInterval(timer.peek());
    timer.value = 0;
  }
  function play() {
    if (reducedMotion()) return range.set(max());
    if (range.get() >= max()) range.set(0);
    timer.value = window.setInterval(
      () => {
        range.set(range.get() + 1);
        if (range.get() >= max()) stop();
      },
      (typeof totalMs === 'number' ? totalMs : totalMs()) / Math.max(1, max()),
    );
  }
  const element = button({ press: () => (timer.peek() ? stop() : play()) }, () =>
    timer.value ? [icon('pause'), 'Pause'] : [icon('play'), label],
  );
  range.input.addEventListener('input', stop);
  return { element, play, stop };
}

/**
 * A chart with a caption. It is redrawn when a signal that `chart` reads changes.
 * @param {{ hidden: () => boolean, chart: () => Drawn, label: string, words: Children,
 * press: (at: number) => void }} about  `label`: for screen readers; `press`: gets the pressed position
 */
export function createChart({ hidden, chart, label, words, press }) {
  /** @param {MouseEvent & { currentTarget: Element }} event */
  const click = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    const { length } = chart().rows[0].counts;
    press(clamp(Math.floor(((clientX - left) / width) * length), 0, length - 1));
  };
  return h(
    'div',
    { class: 'chart', hidden },
    h(
      'div',
      { class: 'plot-axis', 'aria-hidden': 'true' },
      h('span', null, () => scaleOf(chart())),
      h('span', null, () => floorOf(chart())),
    ),
    h('div', { class: 'plot', role: 'img', 'aria-label': label, on: { click } }, () => draw(chart())),
    h('div', { class: 'plot-foot', 'aria-hidden': 'true' }, () => footOf(chart())),
    h('p', { class: 'figure-count' }, words),
  );
}

/**
 * A select with a name.
 * @template {string} T
 * @param {SelectRowOptions<T>} about
 */
export function createSelectRow({ name, choices, value = choices[0]?.value, change }) {
  const id = uniqueId('select');
  /** @type {Signal<string>} */
  const chosen = signal(value);
  /**
   * Includes the value shown, even if it is not one of the choices.
   * @type {Signal<readonly { value: string, label: string }[]>}
   */
  const all = signal(choices);
  const select = createSelect({
    choices: () => all.value,
    value: () => chosen.value,
    change(next) {
      chosen.value = next;
      change(/** @type {T} */ (next));
    },
  });
  select.id = id;
  return {
    element: h('div', { class: 'select-row' }, h('label', { for: id }, name), select),
    select,
    /** Shows a value, even if it is not one of the choices. @param {string} own @param {string} [words] */
    set(own, words = own) {
      if (!all.peek().some((choice) => choice.value === own)) all.value = [...choices, { value: own, label: words }];
      chosen.value = own;
    },
  };
}

/** Names and values in two columns. @param {readonly [string, string][]} rows */
export const facts = (rows) =>
  h(
    'dl',
    { class: 'facts' },
    rows.flatMap(([name, value]) => [h('dt', null, name), h('dd', null, value)]),
  );

/** A colour scale with labelled ends. @param {string} name @param {string} low @param {string} high */
export const createScale = (name, low, high) =>
  h(
    'p',
    { class: 'scale' },
    h('span', null, name),
    h('span', { class: 'scale-end' }, low),
    h('span', { class: 'scale-ramp', 'aria-hidden': 'true' }),
    h('span', { class: 'scale-end' }, high),
  );
