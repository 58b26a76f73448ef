/**
 * The gallery: one picture per surface, as radio buttons, in groups of which one is shown. The last group holds the
 * models from points and the file opened last. A search looks through all groups.
 */
import { batch, computed, effect, signal } from '@preact/signals-core';
import { FILE_SURFACE, FILE_TYPES } from '../../engine/constants.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { icon } from '../icons.js';
import { FORMATS, LIMIT, listOf } from './files.js';

/**
 * @import { Description, Engine } from '../../engine/types.js'
 * @import { Explanation } from '../explain.js'
 * @import { ReadonlySignal, Signal } from '@preact/signals-core'
 */

const PICTURE_PX = 160;
/** Name of the group of models and files. */
const POINTS = 'Points';

/**
 * @param {Engine} engine
 * @param {Description} description
 */
export function createGallery(engine, description) {
  /** @type {Map<string, HTMLInputElement>} */
  const inputs = new Map();

  /**
   * The radio buttons of a group have a name of their own: if all shared one, the chosen one, hidden in another group,
   * would keep the keyboard out of this group.
   * @param {string} group @param {string} id @param {string} name @param {Node} face
   * @param {() => Explanation} help
   */
  function createTile(group, id, name, face, help) {
    const input = h('input', {
      type: 'radio',
      name: `surface-${group}`,
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

  /** @param {string} group @param {{ id: string, name: string, story: string, credit?: string }} entry */
  function pictured(group, { id, name, story, credit }) {
    const picture = h('img', {
      alt: '',
      width: PICTURE_PX,
      height: PICTURE_PX,
      decoding: 'async',
      loading: 'lazy',
      src: `./gallery/${id}.webp`,
    });
    picture.addEventListener(
      'error',
      () => picture.replaceWith(h('span', { class: 'tile-name', 'aria-hidden': 'true' }, name)),
      { once: true },
    );
    return createTile(group, id, name, picture, () => ({ title: name, text: story, ideal: credit }));
  }

  /** Restores the original formula when the present surface is chosen again. @param {string} id */
  function again(id) {
    if (engine.state.peek().surface === id && engine.field.peek()?.surface !== id) engine.setSurface(id);
  }

  const sections = groupsOf(description).map(({ name, entries }) => ({
    name,
    entries,
    tiles: h(
      'div',
      { class: 'tiles', role: 'group', 'aria-label': name },
      entries.map((entry) => pictured(name, entry)),
    ),
  }));
  const models = sections[sections.length - 1].tiles;
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
    models.append(createTile(POINTS, FILE_SURFACE, name, face, () => ({ title: name, text: 'The file opened last.' })));
    check();
  });

  const chosen = computed(() =>
    engine.field.value && engine.field.value.surface === null ? null : engine.state.value.surface,
  );
  function check() {
    for (const [id, input] of inputs) input.checked = id === chosen.peek();
  }

  const shown = signal(sections[0].name);
  const query = signal('');
  effect(() => {
    const id = chosen.value;
    check();
    if (!id) return;
    const group = sections.find(({ entries }) => entries.some((entry) => entry.id === id));
    batch(() => {
      shown.value = group?.name ?? POINTS;
      query.value = '';
    });
    // In the compact layout the gallery is a strip that scrolls. The chosen tile is scrolled into view.
    inputs.get(id)?.closest('label')?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  });
  return h(
    'fieldset',
    { class: 'section gallery' },
    h('legend', { class: 'visually-hidden' }, 'Surface'),
    createGroups(sections, shown, query),
    h('div', { class: 'gallery-find' }, createSearch(query), ...createOpen(engine)),
    sections.map(({ tiles }) => tiles),
    showTiles(sections, shown, query),
  );
}

/**
 * Returns the groups of the gallery in their order, the models last.
 * @param {Description} description
 */
function groupsOf({ surfaces, models }) {
  /** @type {Map<string, { id: string, name: string, story: string, formula?: string, credit?: string }[]>} */
  const groups = new Map();
  for (const entry of surfaces) groups.set(entry.group, [...(groups.get(entry.group) ?? []), entry]);
  groups.set(POINTS, models);
  return [...groups].map(([name, entries]) => ({ name, entries }));
}

/**
 * Shows the tiles of one group, or those of all groups that the search finds. Returns the line that says that there is
 * none.
 * @param {{ name: string, entries: { id: string, name: string, story: string, formula?: string }[], tiles: HTMLElement
 *   }[]} sections
 * @param {ReadonlySignal<string>} shown
 * @param {ReadonlySignal<string>} query
 */
function showTiles(sections, shown, query) {
  const none = h('p', { class: 'quiet', role: 'status' });
  effect(() => {
    const words = query.value.toLowerCase().split(/\s+/).filter(Boolean);
    let isFound = false;
    for (const { name, entries, tiles } of sections) {
      const found = entries.filter((entry) => words.every((word) => textOf(entry).includes(word)));
      isFound ||= found.length > 0;
      tiles.hidden = words.length > 0 ? found.length === 0 : name !== shown.value;
      for (const tile of tiles.children) {
        const { surface } = /** @type {HTMLElement} */ (tile).dataset;
        /** @type {HTMLElement} */ (tile).hidden = words.length > 0 && !found.some(({ id }) => id === surface);
      }
    }
    none.textContent = isFound ? '' : 'No surface has these words in its name, formula or story.';
  });
  return none;
}

/** Returns what the search looks through. @param {{ name: string, story: string, formula?: string }} entry */
const textOf = ({ name, story, formula = '' }) => `${name} ${story} ${formula}`.toLowerCase();

/**
 * Creates the buttons that choose the group.
 * @param {{ name: string }[]} sections
 * @param {Signal<string>} shown
 * @param {Signal<string>} query
 */
function createGroups(sections, shown, query) {
  const buttons = sections.map(({ name }) => {
    const show = () =>
      batch(() => {
        shown.value = name;
        query.value = '';
      });
    const pressed = () => String(query.value.trim() === '' && shown.value === name);
    return h(
      'button',
      { type: 'button', class: 'button small plain', 'aria-pressed': pressed, on: { click: show } },
      name,
    );
  });
  return h('div', { class: 'gallery-groups', role: 'group', 'aria-label': 'Groups of surfaces' }, buttons);
}

/** Creates the search field. @param {Signal<string>} query */
function createSearch(query) {
  const input = h('input', {
    type: 'search',
    class: 'box search',
    placeholder: 'Find a surface',
    'aria-label': 'Find a surface',
    on: {
      input: () => {
        query.value = input.value;
      },
      keydown: (event) => {
        if (event.key !== 'Escape' || input.value === '') return;
        query.value = '';
        event.stopPropagation();
      },
    },
  });
  effect(() => {
    if (input.value !== query.value) input.value = query.value;
  });
  return input;
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
