/**
 * The section below the formula for a triangle mesh: what was mended, what it is treated as, which edges stay sharp,
 * and the distance of the new mesh from the old one.
 */
import { computed } from '@preact/signals-core';
import { button, term } from '../button.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { plural } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createWarning } from '../warning.js';
import { changeOf, facesOf, madeOf, mendedOf } from './mesh-words.js';
import { createTaken } from './taken.js';
import { createWayBack } from './way-back.js';

/** @import { Description, Engine, MeshInfo, ReadonlySignal, Signal } from '../../engine/types.js' */

/** Angle of edges that is preset, in degrees. */
const USUAL_ANGLE = 30;

/**
 * @param {Engine} engine
 * @param {Description} description
 * @param {Signal<boolean>} marking
 */
export function createMesh(engine, description, marking) {
  const info = computed(() => engine.field.value?.mesh ?? null);
  const notes = computed(() => info.value?.notes ?? []);
  const change = computed(() => (info.value ? engine.change.value : null));
  const head = h('div', { class: 'section-head' }, h('h2', null, 'Mesh'));
  const section = h(
    'div',
    { class: 'section remesh', hidden: () => !info.value },
    head,
    createTaken(engine),
    h('p', { class: 'quiet' }, () => info.value && facesOf(info.value)),
    h('p', { class: 'quiet', hidden: () => !info.value?.mended.length }, () => info.value && mendedOf(info.value)),
    createEdges(engine),
    createMarking(engine, marking),
    createBorders(engine, info),
    h('p', { class: 'quiet' }, () => info.value && madeOf(info.value)),
    h(
      'dl',
      { class: 'facts', hidden: () => change.value === null },
      () => change.value && changeOf(change.value, Boolean(info.value?.part?.rim)).map(row),
    ),
    h('ul', { class: 'warnings', hidden: () => notes.value.length === 0 }, () => notes.value.map(createWarning)),
  );
  head.append(createWayBack(engine, description, section));
  return section;
}

/** @param {ReturnType<typeof changeOf>[number]} row */
function row({ label, value, help }) {
  const name = term(() => ({ title: label, text: help }), {}, label);
  return [h('dt', null, name), h('dd', null, value)];
}

/** Creates the choice of edges that stay sharp. @param {Engine} engine */
function createEdges(engine) {
  const value = () => {
    const { edges } = engine.state.value.parameters;
    if (edges === undefined) return 'auto';
    return edges === 0 ? 'none' : 'angle';
  };
  const choice = createSegmented({
    name: 'Sharp edges',
    choices: [
      { value: 'auto', label: 'Auto' },
      { value: 'angle', label: 'By angle' },
      { value: 'none', label: 'None' },
    ],
    value,
    change: (chosen) =>
      choose(engine, chosen === 'auto' ? {} : { edges: chosen === 'angle' ? USUAL_ANGLE : 0 }, ['edges', 'smooth']),
  });
  explain(choice, () => ({
    title: 'Sharp edges',
    text: 'Auto keeps edges of 30° and more where they form curves, unless holes are closed. By angle keeps those whose faces meet at this angle or more. None takes the mesh for a scan and rounds all edges.',
  }));
  return h('div', { class: 'chosen' }, h('span', { class: 'name' }, 'Sharp edges'), choice);
}

/**
 * Creates the button that takes the pointer to mark edges, and what is marked.
 * @param {Engine} engine @param {Signal<boolean>} marking
 */
function createMarking(engine, marking) {
  const count = computed(() => engine.state.value.lines.reduce((sum, line) => sum + line.length - 1, 0));
  const mark = button(
    {
      class: 'small',
      'aria-pressed': () => String(marking.value),
      off: () => engine.field.value?.formula !== '',
      press: () => {
        marking.value = !marking.peek();
      },
    },
    'Mark edges',
  );
  const text = () =>
    engine.field.value?.formula === ''
      ? 'Press edges of the mesh in the picture to keep them sharp, whatever their angle. By keyboard, turn one under the cross and press Enter.'
      : 'The mesh is part of a formula. Edges can be marked while it is alone.';
  const clear = button(
    { class: 'plain small', hidden: () => count.value === 0, press: () => engine.setLines([]) },
    () => `Unmark ${plural(count.value, 'edge')}`,
  );
  return h(
    'div',
    { class: 'chosen' },
    explain(mark, () => ({ text: text() })),
    clear,
  );
}

/**
 * Creates the choice of what becomes of the borders of a mesh that has some.
 * @param {Engine} engine @param {ReadonlySignal<MeshInfo | null>} info
 */
function createBorders(engine, info) {
  // What is chosen shows at once, while the field is still made.
  const value = () => {
    const chosen = engine.state.value.parameters.borders;
    const isKept = chosen === undefined ? Boolean(info.value?.part?.rim) : chosen === 1;
    return isKept ? 'kept' : 'closed';
  };
  const choice = createSegmented({
    name: 'Borders',
    choices: [
      { value: 'kept', label: 'Kept' },
      { value: 'closed', label: 'Closed' },
    ],
    value,
    change: (chosen) => choose(engine, { borders: chosen === 'kept' ? 1 : 0 }, ['borders', 'smooth']),
  });
  explain(choice, () => ({
    title: 'Borders',
    text: 'Kept ends the surface at the borders of the mesh, as for a leaf or a terrain. Closed makes a solid of it, whose holes are closed smoothly.',
  }));
  const hidden = () => !info.value?.border_edges;
  return h('div', { class: 'chosen', hidden }, h('span', { class: 'name' }, 'Borders'), choice);
}

/**
 * Sets choices of the mesh in the place of those with these names.
 * @param {Engine} engine @param {Record<string, number>} chosen @param {string[]} names
 */
function choose(engine, chosen, names) {
  const kept = Object.entries(engine.state.value.parameters).filter(([name]) => !names.includes(name));
  engine.chooseOfFile({ ...Object.fromEntries(kept), ...chosen });
}
