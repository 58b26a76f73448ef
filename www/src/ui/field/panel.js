/** The field panel: the formula, its parameters, the gallery, the clip box and the cutting plane. */
import { computed } from '@preact/signals-core';
import { fill, h, live } from '../dom.js';
import { createClipBox } from './clip-box.js';
import { createCuttingPlane } from './cutting-plane.js';
import { createFormula } from './formula.js';
import { createGallery } from './gallery.js';
import { createImage } from './image.js';
import { createLoading } from './loading.js';
import { createMesh } from './mesh.js';
import { createModel } from './model.js';
import { createParameters } from './parameters.js';
import { createSolid } from './solid.js';
import { storyOf } from './story.js';

/**
 * @import { Description, Engine } from '../../engine/types.js'
 * @import { Motion, Pins, Print, Replace } from '../types.js'
 */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 * @param {{ motion: Motion, pins: Pins, replace: Replace, print: Print }} shared
 */
export function mountField(body, engine, description, shared) {
  fill(
    body,
    h(
      'div',
      { class: 'section entry' },
      createFormula(engine, description, shared.replace),
      createModel(engine, description),
      createImage(engine, description),
      createMesh(engine, description),
      createParameters(engine, shared),
    ),
    createGallery(engine, description, shared.replace),
    ...createLoading(engine),
    createStory(engine, description),
    ...createClipBox(engine),
    createSolid(engine, description, shared.print),
    createCuttingPlane(engine),
  );
  // What follows the sliders appears together with them, so that nothing jumps.
  const waits = () => [engine.field, engine.fieldError, engine.notice, engine.loading].every((own) => !own.value);
  live(body, () => body.classList.toggle('waiting', waits()));
}

/**
 * Shows the name, facts, story and credit of the present surface.
 * @param {Engine} engine
 * @param {Description} description
 */
function createStory(engine, description) {
  const story = computed(() => {
    const field = engine.field.value;
    return storyOf(
      description,
      field ? field.surface : engine.state.value.surface,
      field?.model ?? field?.image ?? field?.mesh ?? null,
    );
  });
  return h('div', { class: 'section story' }, () => {
    const { name, facts, text, credit } = story.value;
    return [
      h('div', { class: 'section-head' }, h('h2', null, name), facts && h('span', { class: 'quiet' }, facts)),
      text && h('p', { class: 'quiet' }, text),
      credit && h('p', { class: 'credit' }, credit),
    ];
  });
}
