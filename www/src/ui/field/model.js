/**
 * Replaces the formula for a surface from points: its facts, how well it fits, and a button that returns to a formula.
 */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { explain } from '../explain.js';
import { factsOf } from './facts.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').Shape} Shape */

/**
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function createModel(engine, description) {
  const facts = h('dl', { class: 'facts' });
  const warnings = h('ul', { class: 'warnings' });
  const back = h(
    'button',
    { type: 'button', class: 'button plain small', on: { click: () => goBack() } },
    'Back to the formula',
  );
  const section = h(
    'div',
    { class: 'section model' },
    h('div', { class: 'section-head' }, h('h2', null, 'Function'), back),
    h(
      'p',
      { class: 'quiet' },
      'f interpolates the points and their normals by Hermite radial basis functions; its zeros are the surface.',
    ),
    facts,
    warnings,
  );

  // The last formula, with its parameters and box, for the way back.
  /** @type {Shape | null} */
  let left = null;
  effect(() => {
    const { surface, formula, parameters, declared, bounds, settings } = engine.state.value;
    if (formula !== '' && engine.field.value?.kind !== 'points')
      left = { surface, formula, parameters, declared, bounds, settings };
  });
  function goBack() {
    if (left) engine.restore({ ...left, settings: engine.state.peek().settings });
    else engine.setSurface(description.default_surface);
  }

  const model = computed(() => (engine.field.value?.kind === 'points' ? engine.field.value.model : null));
  effect(() => {
    section.hidden = engine.field.value?.kind !== 'points';
    const info = model.value;
    fill(
      facts,
      info
        ? factsOf(info).flatMap(({ label, value, unit, help }) => {
            const term = h(
              'button',
              { type: 'button', class: 'term' },
              label,
              unit ? h('span', { class: 'unit' }, `\u00a0${unit}`) : null,
            );
            explain(term, () => ({ title: label, text: help }), { tap: true });
            return [h('dt', null, term), h('dd', null, value)];
          })
        : null,
    );
    const list = info?.warnings ?? [];
    warnings.hidden = list.length === 0;
    fill(
      warnings,
      list.map((text) => h('li', null, text)),
    );
  });
  return section;
}
