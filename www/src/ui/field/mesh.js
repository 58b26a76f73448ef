/**
 * The section below the formula for a triangle mesh: what was mended, what it is treated as, which edges stay sharp,
 * and the distance of the new mesh from the old one.
 */
import { computed } from '@preact/signals-core';
import { term } from '../button.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { createSegmented } from '../segmented.js';
import { createWarning } from '../warning.js';
import { changeOf, facesOf, madeOf, mendedOf } from './mesh-words.js';
import { createTaken } from './taken.js';
import { createWayBack } from './way-back.js';

/** @import { Description, Engine } from '../../engine/types.js' */

/** Angle of edges that is preset, in degrees. */
const USUAL_ANGLE = 30;

/**
 * @param {Engine} engine
 * @param {Description} description
 */
export function createMesh(engine, description) {
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
    h('p', { class: 'quiet' }, () => info.value && madeOf(info.value)),
    h(
      'dl',
      { class: 'facts', hidden: () => change.value === null },
      () => change.value && changeOf(change.value).map(row),
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
    change: (chosen) => engine.chooseOfFile(chosen === 'auto' ? {} : { edges: chosen === 'angle' ? USUAL_ANGLE : 0 }),
  });
  explain(choice, () => ({
    title: 'Sharp edges',
    text: 'Auto keeps edges of 30° and more where they form curves on a closed mesh. By angle keeps those whose faces meet at this angle or more. None takes the mesh for a scan and rounds all edges.',
  }));
  return h('div', { class: 'chosen' }, h('span', { class: 'name' }, 'Sharp edges'), choice);
}
