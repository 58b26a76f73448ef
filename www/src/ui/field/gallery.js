/** The gallery: one picture per surface, chosen like radio buttons. */
import { computed, effect } from '@preact/signals-core';
import { h } from '../dom.js';
import { explain } from '../explain.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

const PICTURE_PX = 160;

/**
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function createGallery(engine, description) {
  /** @type {Map<string, HTMLInputElement>} */
  const inputs = new Map();
  const tiles = description.surfaces.map(({ id, name, story }) => {
    const input = h('input', {
      type: 'radio', name: 'surface', value: id, class: 'visually-hidden', 'aria-label': name,
      on: { change: () => engine.setSurface(id), click: () => again(id) },
    });
    inputs.set(id, input);
    const picture = h('img', { alt: '', width: PICTURE_PX, height: PICTURE_PX, decoding: 'async', src: `./gallery/${id}.webp` });
    picture.addEventListener('error', () => picture.replaceWith(h('span', { class: 'tile-name', 'aria-hidden': 'true' }, name)), { once: true });
    const tile = h('label', { class: 'tile', data: { surface: id } }, input, picture);
    explain(tile, () => ({ title: name, text: story }));
    return tile;
  });

  /** Choosing the present surface again takes its own formula back. @param {string} id */
  function again(id) {
    if (engine.state.peek().surface === id && engine.field.peek()?.surface !== id) engine.setSurface(id);
  }

  const chosen = computed(() => (engine.field.value && engine.field.value.surface === null ? null : engine.state.value.surface));
  effect(() => {
    for (const [id, input] of inputs) input.checked = id === chosen.value;
    // In a strip the chosen one may stand outside: bring it in.
    if (chosen.value) inputs.get(chosen.value)?.closest('label')?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  });
  return h('fieldset', { class: 'section gallery' }, h('legend', { class: 'visually-hidden' }, 'Surface'), tiles);
}
