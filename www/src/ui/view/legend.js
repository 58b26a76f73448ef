/** Shows the choice of colouring and its legend, with range and unit. */
import { computed } from '@preact/signals-core';
import { h, live, marked, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';
import { createSelect } from '../select.js';

/**
 * @import { Description, Engine, Legend } from '../../engine/types.js'
 * @import { Child } from '../types.js'
 */

/**
 * @param {Engine} engine
 * @param {Description} description
 */
export function createLegend(engine, { colours }) {
  const select = createSelect({
    name: 'Colour by',
    choices: colours.map(({ id, label }) => ({ value: id, label })),
    value: () => engine.state.value.view.colour,
    change: (colour) => engine.setView({ colour }),
  });
  explain(select, () => {
    const entry = colours.find(({ id }) => id === engine.state.peek().view.colour);
    return entry ? { title: entry.label, text: entry.help } : null;
  });
  const legend = () => engine.legend.value;
  const scale = h(
    'div',
    {
      class: () => (legend()?.pending ? 'scale pending' : 'scale'),
      hidden: () => !legend() || legend()?.kind === 'plain' || (isValue(engine) && engine.valueFault.value !== null),
    },
    () => {
      const now = legend();
      return now && SCALES[now.kind](now);
    },
  );
  const dots = h('div', { class: 'scale', hidden: () => !legend()?.dots }, () => [
    h('span', null, 'Dots: not six neighbours, but'),
    listOf(legend()?.dots),
  ]);
  return h('div', { class: 'legend' }, select, createValue(engine), scale, dots);
}

/** @param {Engine} engine */
const isValue = (engine) => engine.state.value.view.colour === 'value';

/** Suggested values, with their meanings. */
const VALUES = [
  ['k_1 k_2', 'Gaussian curvature'],
  ['k_1', 'larger principal curvature'],
  ['max(abs(k_1), abs(k_2))', 'sharpest bend'],
  ['edge', 'distance to the nearest sharp edge or rim'],
  ['area', 'share of the surface'],
  ['n_z', 'how far it faces up'],
  ['z', 'height'],
  ['hypot(x, y)', 'distance from the axis'],
];

/** Creates the text box of the formula for colouring the particles. @param {Engine} engine */
function createValue(engine) {
  const [told, list] = [uniqueId('value'), uniqueId('values')];
  const box = h('input', {
    type: 'text',
    class: 'box formula-box',
    autocomplete: 'off',
    autocapitalize: 'off',
    spellcheck: false,
    'aria-label': 'Formula of the colours',
    'aria-describedby': told,
    'aria-invalid': () => String(engine.valueFault.value !== null),
    on: {
      change: () => {
        if (box.value.trim() === '') box.value = engine.state.peek().view.value;
        else engine.setView({ value: box.value.trim() });
      },
    },
  });
  box.setAttribute('list', list);
  // Other changes of the state keep the text being typed.
  const value = computed(() => engine.state.value.view.value);
  live(box, () => {
    box.value = value.value;
  });
  return h(
    'div',
    { class: 'legend-value', hidden: () => !isValue(engine) },
    box,
    h(
      'datalist',
      { id: list },
      VALUES.map(([value, label]) => h('option', { value }, label)),
    ),
    h('p', { class: 'fault-line', id: told, role: 'alert', hidden: () => engine.valueFault.value === null }, () =>
      marked(engine.valueFault.value ?? ''),
    ),
  );
}

/** @param {string} colour */
const swatch = (colour) => h('span', { class: 'swatch', 'aria-hidden': 'true', style: { 'background-color': colour } });

/** @param {Legend['entries']} [entries] */
const listOf = (entries = []) =>
  h(
    'ul',
    { class: 'categories' },
    entries.map(({ label, colour, count }) =>
      h(
        'li',
        null,
        swatch(colour),
        h('span', null, label),
        count === undefined ? null : h('span', { class: 'count' }, formatCount(count)),
      ),
    ),
  );

/** @type {Record<Legend['kind'], (legend: Legend) => Child[]>} */
const SCALES = {
  plain: () => [],
  categories: ({ entries }) => [listOf(entries)],
  normal: (legend) => SCALES.categories(legend),
  sequential: (legend) => rampOf(legend, ([low, high]) => [formatSignificant(low), formatSignificant(high)]),
  // Values outside the range have the colour of its end.
  diverging: (legend) =>
    rampOf(legend, ([low, high]) => [`≤\u2009${formatSignificant(low, 2)}`, `≥\u2009${formatSignificant(high, 2)}`]),
};

/**
 * Creates a colour ramp with figures at its ends and a tick at the legend's mark.
 * @param {Legend} legend
 * @param {(range: [number, number]) => [string, string]} write
 */
function rampOf({ colours, range, mark, unit, kind }, write) {
  const style = { 'background-image': `linear-gradient(to right, ${colours.join(', ')})` };
  const ramp = h('div', { class: 'ramp', 'aria-hidden': 'true', style });
  if (!range) return [ramp];
  const [low, high] = range;
  if (low === high) return [ramp, h('div', { class: 'ends' }, h('span', null, `${formatSignificant(low)} everywhere`))];
  const share = mark === undefined ? NaN : (mark - low) / (high - low);
  if (share >= 0 && share <= 1) ramp.append(h('span', { class: 'tick', style: { left: `${share * 100}%` } }));
  const [first, last] = write(range);
  // The middle of a diverging ramp shows the zero, so its unit is part of the title.
  const middle = kind === 'diverging' ? h('span', null, '0') : unit ? h('span', { class: 'unit' }, unit) : null;
  const ends = h('div', { class: 'ends', data: { kind } }, h('span', null, first), middle, h('span', null, last));
  return kind === 'diverging' && unit ? [ramp, ends, h('span', { class: 'unit' }, unit)] : [ramp, ends];
}
