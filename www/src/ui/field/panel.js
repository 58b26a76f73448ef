/** The field panel: the formula, its parameters, the gallery, the clip box and the cutting plane. */
import { computed } from '@preact/signals-core';
import { fill, h, live, release } from '../dom.js';
import { createClipBox } from './clip-box.js';
import { createCuttingPlane } from './cutting-plane.js';
import { createFormula } from './formula.js';
import { createGallery } from './gallery.js';
import { createImage } from './image.js';
import { createLoading } from './loading.js';
import { createModel } from './model.js';
import { createParameters } from './parameters.js';
import { createSolid } from './solid.js';
import { storyOf } from './story.js';

/**
 * @import { Description, Engine, Signal } from '../../engine/types.js'
 * @import { Hands, Motion, Print, Replace } from '../types.js'
 */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 * @param {Pick<Hands, 'pins' | 'marking'> & { motion: Motion, replace: Replace, print: Print }} shared
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
      createMeshLater(engine, description, shared.marking),
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
 * Returns the place of the section for a triangle mesh, which is loaded with the first of them.
 * @param {Engine} engine @param {Description} description @param {Signal<boolean>} marking
 */
function createMeshLater(engine, description, marking) {
  const place = h('div', { hidden: true });
  const isMesh = computed(() => Boolean(engine.field.value?.mesh));
  live(place, () => {
    if (!isMesh.value) return;
    import('./mesh.js').then(
      ({ createMesh }) => {
        if (place.isConnected) place.replaceWith(createMesh(engine, description, marking));
        release(place);
      },
      () => {},
    );
  });
  return place;
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
