/**
 * The section below the formula for a surface from points: its facts, how well it fits, and a button that returns to
 * the formula before it.
 */
import { computed } from '@preact/signals-core';
import { term } from '../button.js';
import { h, live } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount } from '../format.js';
import { createSlider } from '../slider.js';
import { createWarning } from '../warning.js';
import { factsOf, fittedOf, plainOf } from './facts.js';
import { createTaken } from './taken.js';
import { createWayBack } from './way-back.js';

/** @import { Description, Engine, ModelInfo, ReadonlySignal } from '../../engine/types.js' */

/**
 * @param {Engine} engine
 * @param {Description} description
 */
export function createModel(engine, description) {
  const model = computed(() => engine.field.value?.model ?? null);
  const warnings = computed(() => model.value?.warnings ?? []);
  const head = h('div', { class: 'section-head' }, h('h2', null, 'Function'));
  const section = h(
    'div',
    { class: 'section model', hidden: () => !model.value },
    head,
    createTaken(engine),
    h('p', { class: 'quiet' }, () => model.value && plainOf(model.value)),
    h(
      'details',
      { class: 'details' },
      h('summary', { class: 'disclose' }, 'Details'),
      h('p', { class: 'quiet' }, () => model.value && fittedOf(model.value)),
      createCentres(engine, description, model),
      h('dl', { class: 'facts' }, () => model.value && factsOf(model.value).map(factElements)),
    ),
    h('ul', { class: 'warnings', hidden: () => warnings.value.length === 0 }, () => warnings.value.map(createWarning)),
  );

  head.append(createWayBack(engine, description, section));
  return section;
}

/** @param {ReturnType<typeof factsOf>[number]} fact */
function factElements({ label, value, unit, help }) {
  const name = term(
    () => ({ title: label, text: help }),
    {},
    label,
    unit && h('span', { class: 'unit' }, `\u00a0${unit}`),
  );
  return [h('dt', null, name), h('dd', null, value)];
}

/**
 * Creates the control of the number of centres.
 * @param {Engine} engine
 * @param {Description} description
 * @param {ReadonlySignal<ModelInfo | null>} model
 */
function createCentres(engine, { limits }, model) {
  const scale = { min: limits.centres_min, max: limits.centres_max, step: 10, integer: true };
  /** The default number for the present model. */
  let usual = limits.centres;
  const slider = createSlider({
    name: 'Centres',
    scale,
    value: usual,
    describe: formatCount,
    // Solving takes seconds, so it starts at the end of a drag.
    change: (value, live) => {
      if (!live) engine.setCentres(value);
    },
    reset: () => engine.setCentres(usual),
    read: engine.readNumber,
  });
  const caption = h('span', { class: 'name' }, 'Centres');
  const row = h('div', { class: 'row centres' }, caption, slider.range, slider.box);
  explain(caption, () => ({
    title: 'Centres',
    text: 'How many points the surface is built around. The other points correct the nearest of these. More of them follow finer details; the time to solve for them grows with the cube of their number.',
  }));
  live(row, () => {
    const info = model.value;
    // While the model is solved for another number, the slider shows that number.
    const asked = engine.loading.value && engine.state.value.centres;
    if (!info) return;
    const max = Math.min(limits.centres_max, info.points);
    usual = Math.min(limits.centres, max);
    row.hidden = max <= limits.centres_min;
    slider.setScale({ ...scale, max });
    slider.set(asked ?? info.centres);
  });
  return row;
}
