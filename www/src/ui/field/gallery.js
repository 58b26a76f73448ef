/**
 * The gallery: one picture per surface, as radio buttons. Formulas come first, then models from points and the file
 * opened last.
 */
import { computed, effect } from '@preact/signals-core';
import { FILE_SURFACE, FILE_TYPES } from '../../engine/types.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { icon } from '../icons.js';
import { FORMATS, LIMIT, listOf } from './files.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

const PICTURE_PX = 160;

/**
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function createGallery(engine, description) {
  /** @type {Map<string, HTMLInputElement>} */
  const inputs = new Map();

  /** @param {string} id @param {string} name @param {Node} face @param {() => import('../explain.js').Explanation} help */
  function createTile(id, name, face, help) {
    const input = h('input', {
      type: 'radio',
      name: 'surface',
      value: id,
      class: 'visually-hidden',
      'aria-label': name,
      on: { change: () => engine.setSurface(id), click: () => again(id) },
    });
    inputs.set(id, input);
    const tile = h('label', { class: 'tile', data: { surface: id } }, input, face);
    explain(tile, help);
    return tile;
  }

  /** @param {{ id: string, name: string, story: string, credit?: string }} entry */
  function pictured({ id, name, story, credit }) {
    const picture = h('img', {
      alt: '',
      width: PICTURE_PX,
      height: PICTURE_PX,
      decoding: 'async',
      src: `./gallery/${id}.webp`,
    });
    picture.addEventListener(
      'error',
      () => picture.replaceWith(h('span', { class: 'tile-name', 'aria-hidden': 'true' }, name)),
      { once: true },
    );
    return createTile(id, name, picture, () => ({ title: name, text: story, ideal: credit }));
  }

  /** Restores the original formula when the present surface is chosen again. @param {string} id */
  function again(id) {
    if (engine.state.peek().surface === id && engine.field.peek()?.surface !== id) engine.setSurface(id);
  }

  const models = h(
    'div',
    { class: 'tiles', role: 'group', 'aria-label': 'From points' },
    description.models.map(pictured),
  );
  const open = createOpen(engine);
  models.append(...open);
  // The file opened last has its own tile, by which the user can return to it.
  const file = computed(() =>
    engine.field.value?.surface === FILE_SURFACE ? (engine.field.value.model?.name ?? 'File') : null,
  );
  let fileName = '';
  effect(() => {
    const name = file.value;
    if (name === null || name === fileName) return;
    fileName = name;
    inputs.get(FILE_SURFACE)?.closest('label')?.remove();
    const face = h('span', { class: 'tile-name', 'aria-hidden': 'true' }, icon('file'), extensionOf(name));
    open[0].before(createTile(FILE_SURFACE, name, face, () => ({ title: name, text: 'The file opened last.' })));
    check();
  });

  const chosen = computed(() =>
    engine.field.value && engine.field.value.surface === null ? null : engine.state.value.surface,
  );
  function check() {
    for (const [id, input] of inputs) input.checked = id === chosen.peek();
  }
  effect(() => {
    void chosen.value;
    check();
    // In the compact layout the gallery is a strip that scrolls. The chosen tile is scrolled into view.
    if (chosen.value)
      inputs.get(chosen.value)?.closest('label')?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  });
  return h(
    'fieldset',
    { class: 'section gallery' },
    h('legend', { class: 'visually-hidden' }, 'Surface'),
    h('div', { class: 'tiles', role: 'group', 'aria-label': 'Formulas' }, description.surfaces.map(pictured)),
    h('h2', { class: 'tiles-head' }, 'From points'),
    models,
  );
}

/** @param {string} name */
const extensionOf = (name) => /\.([a-z0-9]{1,4})$/i.exec(name)?.[1].toUpperCase() ?? 'File';

/** Creates the button that opens a file, and its file chooser. @param {Engine} engine @returns {HTMLElement[]} */
function createOpen(engine) {
  const chooser = h('input', {
    type: 'file',
    accept: FILE_TYPES,
    hidden: true,
    on: {
      change: () => {
        const file = chooser.files?.[0];
        // Without this, choosing the same file again after a change would send no event.
        chooser.value = '';
        if (file) void engine.openFile(file);
      },
    },
  });
  const button = h(
    'button',
    { type: 'button', class: 'button open-file', on: { click: () => chooser.click() } },
    'Open file…',
  );
  explain(button, () => ({
    title: 'A file of points',
    text: `${listOf(FORMATS)}, up to ${LIMIT}: points with normals, points alone, or a mesh. It stays on this device. It can also be dropped anywhere on the page.`,
  }));
  return [button, chooser];
}
