/** The field panel: which surface, its formula, its parameters, its box. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { createGallery } from './gallery.js';
import { createFormula } from './formula.js';
import { createParameters } from './parameters.js';
import { createClipBox } from './clip-box.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').Description} Description */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 */
export function mountField(body, engine, description) {
  fill(
    body,
    createGallery(engine, description),
    createStory(engine, description),
    createFormula(engine, description),
    createParameters(engine),
    createClipBox(engine),
  );
}

/** Name, degree, genus and story of the surface at hand. @param {Engine} engine @param {Description} description */
function createStory(engine, description) {
  const section = h('div', { class: 'section story' });
  const surface = computed(() => {
    const field = engine.field.value;
    return field ? field.surface : engine.state.value.surface;
  });
  effect(() => {
    const entry = description.surfaces.find(({ id }) => id === surface.value);
    const facts = entry
      ? [entry.degree === null ? null : `Degree ${entry.degree}`, entry.genus === null ? null : `genus ${entry.genus}`].filter(Boolean).join(' · ')
      : '';
    fill(
      section,
      h('div', { class: 'section-head' }, h('h2', null, entry ? entry.name : 'Your own formula'), facts ? h('span', { class: 'quiet' }, facts) : null),
      entry && !entry.story ? null : h('p', { class: 'quiet' }, entry ? entry.story : 'The surface where the formula below is zero. Names other than x, y and z become sliders.'),
    );
  });
  return section;
}
