/** What the colours mean: the choice of the colouring, and its legend with range and unit. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').Legend} Legend */
/** @typedef {import('../../engine/types.js').ColourMode} ColourMode */

/**
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function createLegend(engine, description) {
  const select = h(
    'select',
    { class: 'select', 'aria-label': 'Colour by', on: { change: () => engine.setView({ colour: /** @type {ColourMode} */ (select.value) }) } },
    description.colours.map(({ id, label }) => h('option', { value: id }, label)),
  );
  const colour = computed(() => engine.state.value.view.colour);
  effect(() => { select.value = colour.value; });
  explain(select, () => {
    const entry = description.colours.find(({ id }) => id === colour.peek());
    return entry ? { title: entry.label, text: entry.help } : null;
  });
  const scale = h('div', { class: 'scale' });
  effect(() => {
    const legend = engine.legend.value;
    scale.hidden = !legend || legend.kind === 'plain';
    if (legend) fill(scale, SCALES[legend.kind](legend));
    scale.classList.toggle('pending', legend?.pending === true);
  });
  return h('div', { class: 'legend' }, select, scale);
}

/** @param {string} colour */
function swatch(colour) {
  const element = h('span', { class: 'swatch', 'aria-hidden': 'true' });
  element.style.backgroundColor = colour;
  return element;
}

/** @type {Record<Legend['kind'], (legend: Legend) => import('../dom.js').Child[]>} */
const SCALES = {
  plain: () => [],
  cyclic: ({ colours }) => [
    h('div', { class: 'cycle', role: 'img', 'aria-label': `${colours.length} colours, repeating` }, colours.map(swatch)),
    h('div', { class: 'ends' }, h('span', null, '0'), h('span', null, `${colours.length - 1}, then again`)),
  ],
  categories: ({ entries }) => [
    h('ul', { class: 'categories' }, (entries ?? []).map(({ label, colour, count }) => h(
      'li',
      null,
      swatch(colour),
      h('span', null, label),
      count === undefined ? null : h('span', { class: 'count' }, formatCount(count)),
    ))),
  ],
  diverging: (legend) => SCALES.sequential(legend),
  normal: (legend) => (legend.entries?.length ? SCALES.categories(legend) : SCALES.cyclic(legend)),
  sequential: ({ colours, range, mark, unit }) => {
    const ramp = h('div', { class: 'ramp', 'aria-hidden': 'true' });
    ramp.style.backgroundImage = `linear-gradient(to right, ${colours.join(', ')})`;
    if (!range) return [ramp];
    const [low, high] = range;
    const tick = h('span', { class: 'tick' });
    const inside = mark !== undefined && mark >= low && mark <= high && high > low;
    if (inside) {
      tick.style.left = `${((mark - low) / (high - low)) * 100}%`;
      ramp.append(tick);
    }
    return [
      ramp,
      h(
        'div',
        { class: 'ends' },
        h('span', null, formatSignificant(low)),
        unit ? h('span', { class: 'unit' }, unit) : null,
        h('span', null, formatSignificant(high)),
      ),
    ];
  },
};
