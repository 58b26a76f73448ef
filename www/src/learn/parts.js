/** Controls and charts shared by several figures. */

import { computed, signal } from '@preact/signals-core';
import { clamp } from '../engine/vector.js';
import { algorithmList } from '../figures/algorithm.js';
import { momentAt } from '../figures/moment.js';
import { ALGORITHM, lineOf, tell } from '../figures/words.js';
import { button } from '../ui/button.js';
import { draw, floorOf, footOf, scaleOf } from '../ui/chart.js';
import { h, reducedMotion, uniqueId } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { icon } from '../ui/icons.js';
import { createRange } from '../ui/range.js';
import { createSelect } from '../ui/select.js';

/** @import { Children, Drawn } from '../ui/types.js' */

/** @import { RangeRowOptions, SelectRowOptions, StepsOptions } from './types.js' */

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
export function createSelectRow({ name, isLocked = false, ...about }) {
  const select = createSelect(about);
  select.id = uniqueId('select');
  select.disabled = isLocked;
  return h('div', { class: 'select-row' }, h('label', { for: select.id }, name), select);
}

/**
 * Steps through the events of a particle: what is told of the present one, buttons and a range, and its line of the
 * algorithm.
 * @param {StepsOptions} about
 */
export function createSteps({ name, events, first, subject, lines = ALGORITHM, beyond = () => {} }) {
  const last = () => Math.max(0, events().length - 1);
  // With fewer events than before the present position may no longer exist.
  const known = (/** @type {number} */ place) => Math.min(place, last());
  const range = createRangeRow({
    name,
    max: last,
    value: first,
    say: (place) => `${formatCount(known(place) + 1)} of ${formatCount(last() + 1)}`,
    change() {},
  });
  const at = () => known(range.place.value);
  const moment = computed(() => momentAt(events(), at()));
  const step = (/** @type {1 | -1} */ by, /** @type {string} */ label, /** @type {'back' | 'forward'} */ icon) =>
    button({
      class: 'square',
      icon,
      'aria-label': label,
      press() {
        const to = at() + by;
        if (to >= 0 && to <= last()) range.set(to);
        else beyond(by);
      },
    });
  return {
    moment,
    elements: [
      h('p', { class: 'told', 'aria-live': 'polite' }, () => tell(moment.value, subject())),
      h('div', { class: 'controls' }, step(-1, 'Step back', 'back'), step(1, 'Step forward', 'forward'), range.element),
      h('div', { class: 'particle-lines' }, () => algorithmList(lineOf(moment.value.event, lines), lines)),
    ],
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
