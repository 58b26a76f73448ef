/**
 * The gallery: one picture per surface, as radio buttons, in groups of which one is shown. The last group holds the
 * models from points and the last opened file. A search covers all groups.
 */

import { batch, computed, signal } from '@preact/signals-core';
import { FILE_SURFACE, FILE_TYPES, IMAGE_TYPES, MESH_TYPES } from '../../engine/constants.js';
import { givenOf } from '../../engine/given.js';
import { SCANS } from '../../engine/scans.js';
import { button } from '../button.js';
import { h, live } from '../dom.js';
import { explain } from '../explain.js';
import { icon } from '../icons.js';
import { createSelect } from '../select.js';
import { filesOf, IMAGE_FORMATS, MESH_FORMATS, ofFiles } from './files.js';

/**
 * @import { Description, Engine, ReadonlySignal, Signal } from '../../engine/types.js'
 * @import { Replace } from '../types.js'
 * @import { Entry, Finding } from './types.js'
 */

const PICTURE_PX = 160;
/** Name of the group of models and files. */
const POINTS = 'Points';
/** Name that the group menu shows while a search covers all groups. */
const ALL = 'All';

/**
 * @param {Engine} engine
 * @param {Description} description
 * @param {Replace} replace
 */
export function createGallery(engine, description, replace) {
  const groups = groupsOf(description);
  const shown = signal(groups[0].name);
  const query = signal('');
  const words = computed(() => query.value.toLowerCase().split(/\s+/).filter(Boolean));
  const chosen = computed(() =>
    engine.field.value && engine.field.value.surface === null ? null : engine.state.value.surface,
  );
  const choose = (/** @type {string} */ id) => replace(() => engine.setSurface(id));
  const finding = { words, chosen, choose };
  const tiles = groups.map(({ name, entries }) =>
    h(
      'div',
      {
        class: 'tiles',
        role: 'group',
        'aria-label': name,
        hidden: () =>
          words.value.length > 0 ? !entries.some((entry) => has(entry, words.value)) : name !== shown.value,
      },
      entries.map((entry) => pictured(engine, finding, name, entry)),
      name === POINTS && createFileTile(engine, finding),
    ),
  );
  const gallery = h(
    'fieldset',
    { class: 'section gallery' },
    h('legend', { class: 'visually-hidden' }, 'Surface'),
    h(
      'div',
      { class: 'gallery-find' },
      createGroups(groups, { shown, query, words }),
      createSearch(query),
      createOpen(engine),
    ),
    tiles,
    h('p', { class: 'quiet', role: 'status' }, () =>
      groups.some(({ entries }) => entries.some((entry) => has(entry, words.value)))
        ? ''
        : 'No surface has these words in its name, formula or story.',
    ),
  );
  live(gallery, () => {
    const id = chosen.value;
    if (!id) return;
    batch(() => {
      shown.value = groups.find(({ entries }) => entries.some((entry) => entry.id === id))?.name ?? POINTS;
      query.value = '';
    });
    // In a small window the group is a strip. Only the strip scrolls to the chosen tile, not the panel around it.
    const tile = gallery.querySelector(`[data-surface="${id}"]`);
    const strip = tile?.closest('.tiles');
    if (!tile || !strip) return;
    const [own, all] = [tile.getBoundingClientRect(), strip.getBoundingClientRect()];
    strip.scrollLeft += Math.min(0, own.left - all.left) + Math.max(0, own.right - all.right);
  });
  return gallery;
}

/**
 * Creates a tile. The radio buttons of a group have a name of their own: if all shared one, the chosen one, hidden in
 * another group, would keep the keyboard out of this group.
 * @param {Engine} engine
 * @param {Finding} finding
 * @param {{ group: string, entry: Entry, face: Node, isFound: () => boolean }} tile  what it shows, and whether the
 *   search finds it
 */
function createTile(engine, { words, chosen, choose }, { group, entry: { id, name, story, credit }, face, isFound }) {
  // Choosing the present surface again restores its original formula.
  const again = () => {
    if (engine.state.peek().surface === id && engine.field.peek()?.surface !== id) choose(id);
  };
  const input = h('input', {
    type: 'radio',
    name: `surface-${group}`,
    value: id,
    class: 'visually-hidden',
    'aria-label': name,
    prop: { checked: () => chosen.value === id },
    on: { change: () => choose(id), click: again },
  });
  const hidden = () => words.value.length > 0 && !isFound();
  const caption = h('span', { class: 'tile-name', 'aria-hidden': 'true' }, name);
  return explain(h('label', { class: 'tile', hidden, data: { surface: id } }, input, face, caption), () => ({
    title: name,
    text: story,
    ideal: credit,
  }));
}

/** @param {Engine} engine @param {Finding} finding @param {string} group @param {Entry} entry */
function pictured(engine, finding, group, entry) {
  const picture = h('img', {
    class: 'tile-face',
    alt: '',
    width: PICTURE_PX,
    height: PICTURE_PX,
    decoding: 'async',
    loading: 'lazy',
    src: `./gallery/${entry.id}.webp`,
    on: { error: () => picture.replaceWith(h('span', { class: 'tile-face' })) },
  });
  const isFound = () => has(entry, finding.words.value);
  return createTile(engine, finding, { group, entry, face: picture, isFound });
}

/**
 * Creates the tile of the last opened file, by which the user can return to it.
 * @param {Engine} engine @param {Finding} finding
 */
function createFileTile(engine, finding) {
  let last = '';
  const file = computed(() => {
    if (engine.field.value?.surface === FILE_SURFACE) last = givenOf(engine.field.value)?.name ?? 'File';
    return last;
  });
  return () => {
    const name = file.value;
    const entry = { id: FILE_SURFACE, name, story: 'The file opened last.' };
    const face = h('span', { class: 'tile-face', 'aria-hidden': 'true' }, icon('file'), extensionOf(name));
    return name && createTile(engine, finding, { group: POINTS, entry, face, isFound: () => false });
  };
}

/**
 * Returns the groups of the gallery in their order, the computed images and the models last.
 * @param {Description} description
 */
function groupsOf({ surfaces, models }) {
  /** @type {Map<string, Entry[]>} */
  const groups = new Map();
  for (const entry of surfaces) groups.set(entry.group, [...(groups.get(entry.group) ?? []), entry]);
  groups.set('Scans', [...SCANS]);
  groups.set(POINTS, models);
  return [...groups].map(([name, entries]) => ({ name, entries }));
}

/**
 * Returns whether each word begins a word of a surface's texts or is contained in its formula.
 * @param {Entry} entry @param {readonly string[]} words
 */
function has({ name, story, formula = '', words: others = '' }, words) {
  const said = `${name} ${others} ${story}`.toLowerCase();
  return words.every((word) => begins(said, word) || formula.toLowerCase().includes(word));
}

/** Whether some word of a text begins with `word`. @param {string} text @param {string} word */
function begins(text, word) {
  for (let at = text.indexOf(word); at >= 0; at = text.indexOf(word, at + 1))
    if (!/[\p{L}\p{N}]/u.test(text[at - 1] ?? '')) return true;
  return false;
}

/**
 * Creates the menu of groups. During a search it shows that all are searched.
 * @param {{ name: string }[]} sections
 * @param {{ shown: Signal<string>, query: Signal<string>, words: ReadonlySignal<readonly string[]> }} how
 */
function createGroups(sections, { shown, query, words }) {
  const groups = sections.map(({ name }) => ({ value: name, label: name }));
  const all = [...groups, { value: ALL, label: ALL }];
  const isSearch = () => words.value.length > 0;
  return createSelect({
    name: 'Group of surfaces',
    choices: () => (isSearch() ? all : groups),
    value: () => (isSearch() ? ALL : shown.value),
    change: (name) =>
      batch(() => {
        shown.value = name;
        query.value = '';
      }),
  });
}

/** Creates the search field. @param {Signal<string>} query */
function createSearch(query) {
  const input = h('input', {
    type: 'search',
    class: 'box search',
    placeholder: 'Search',
    'aria-label': 'Find a surface',
    prop: { value: () => query.value },
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
  return input;
}

/** The extension of a file, without that of its compression. @param {string} name */
const extensionOf = (name) => /\.([a-z0-9]{1,4})(\.gz)?$/i.exec(name)?.[1].toUpperCase() ?? 'File';

/** Creates the button that opens a file, and its file chooser. @param {Engine} engine */
function createOpen(engine) {
  const chooser = h('input', {
    type: 'file',
    accept: [FILE_TYPES, MESH_TYPES, IMAGE_TYPES].join(),
    multiple: true,
    hidden: true,
    on: {
      change: () => {
        const { file, beside } = ofFiles([...(chooser.files ?? [])]);
        // Without this, choosing the same file again after a change would send no event.
        chooser.value = '';
        if (file) void engine.openFile(file, beside);
      },
    },
  });
  const opener = button({ class: 'open-file', press: () => chooser.click() }, 'Open file…');
  explain(opener, () => ({
    title: 'A mesh, points or an image',
    text: `${MESH_FORMATS}: a triangle mesh, which is sampled anew. ${filesOf(engine)}: points. ${IMAGE_FORMATS}: a three-dimensional image. It stays on this device. It can also be dropped anywhere on the page.`,
  }));
  return [opener, chooser];
}
