/**
 * The section below the formula for a three-dimensional image: its facts, the choice between grey values and labels,
 * the list of labels, and which voxels are inside.
 */
import { computed } from '@preact/signals-core';
import { h, s, uniqueId } from '../dom.js';
import { formatSignificant, plural } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createWarning } from '../warning.js';
import { barsOf, filteredOf, voxelsOf } from './image-words.js';
import { createWayBack } from './way-back.js';

/** @import { Description, Engine, ImageFacts, ImageInfo, ReadonlySignal } from '../../engine/types.js' */

/**
 * @param {Engine} engine
 * @param {Description} description
 */
export function createImage(engine, description) {
  const info = computed(() => engine.field.value?.image ?? null);
  const facts = computed(() => (info.value ? engine.image.value : null));
  const labels = computed(() => facts.value?.labels ?? []);
  const notes = computed(() => info.value?.notes ?? []);
  const head = h('div', { class: 'section-head' }, h('h2', null, 'Image'));
  const section = h(
    'div',
    { class: 'section image', hidden: () => !info.value },
    head,
    h('p', { class: 'quiet' }, () => facts.value && voxelsOf(facts.value)),
    h('div', { class: 'chosen', hidden: () => labels.value.length === 0 }, createKind(engine, labels)),
    createLabels(engine, labels, info),
    h('div', { class: 'chosen', hidden: () => info.value?.label !== null }, createSide(engine)),
    h('div', { class: 'chosen' }, createBorder(engine)),
    h('p', { class: 'quiet' }, () => info.value && filteredOf(info.value)),
    h('ul', { class: 'warnings', hidden: () => notes.value.length === 0 }, () => notes.value.map(createWarning)),
  );
  head.append(createWayBack(engine, description, section));
  return section;
}

/**
 * Creates the choice between grey values and labels.
 * @param {Engine} engine
 * @param {ReadonlySignal<ImageFacts['labels']>} labels
 */
function createKind(engine, labels) {
  const largest = () => {
    const bodies = labels.peek().filter(({ value }) => value !== 0);
    return bodies.reduce((a, b) => (b.voxels > a.voxels ? b : a)).value;
  };
  return createSegmented({
    name: 'Surface of the image',
    choices: [
      { value: 'label', label: 'Label' },
      { value: 'iso', label: 'Iso value' },
    ],
    value: () => (engine.state.value.parameters.label === undefined ? 'iso' : 'label'),
    change: (value) =>
      engine.chooseOfFile(value === 'label' ? { ...ofBorder(engine), label: largest() } : ofBorder(engine)),
  });
}

/**
 * Creates the list of labels with their sizes.
 * @param {Engine} engine
 * @param {ReadonlySignal<ImageFacts['labels']>} labels @param {ReadonlySignal<ImageInfo | null>} info
 */
function createLabels(engine, labels, info) {
  const group = uniqueId('labels');
  return h(
    'div',
    { class: 'labels', role: 'radiogroup', 'aria-label': 'Labels', hidden: () => info.value?.label === null },
    () =>
      labels.value.map(({ value, voxels }) =>
        h(
          'label',
          { class: 'check' },
          h('input', {
            type: 'radio',
            name: group,
            prop: { checked: () => engine.state.value.parameters.label === value },
            on: { change: () => engine.chooseOfFile({ ...kept(engine), label: value }) },
          }),
          h('span', null, formatSignificant(value, 6)),
          h('span', { class: 'quiet' }, value === 0 ? 'background, ' : '', plural(voxels, 'voxel')),
        ),
      ),
  );
}

/** The parameters that choosing another label keeps. @param {Engine} engine @returns {Record<string, number>} */
function kept(engine) {
  const { smooth } = engine.state.peek().parameters;
  return { ...(smooth === undefined ? {} : { smooth }), ...ofBorder(engine) };
}

/** The choice for the border of the image. @param {Engine} engine @returns {Record<string, number>} */
function ofBorder(engine) {
  const { closed } = engine.state.peek().parameters;
  return closed ? { closed } : {};
}

/** Creates the choice of the inner side. @param {Engine} engine */
function createSide(engine) {
  return createSegmented({
    name: 'Inside',
    choices: [
      { value: 'bright', label: 'Bright inside' },
      { value: 'dark', label: 'Dark inside' },
    ],
    value: () => (engine.state.value.parameters.dark ? 'dark' : 'bright'),
    change: (value) => {
      const { dark: _, ...others } = engine.state.peek().parameters;
      engine.chooseOfFile(value === 'dark' ? { ...others, dark: 1 } : others);
    },
  });
}

/** Creates the choice of what becomes of a surface that the border of the image cuts. @param {Engine} engine */
function createBorder(engine) {
  return createSegmented({
    name: 'At the border of the image',
    choices: [
      { value: 'open', label: 'Open at the border' },
      { value: 'closed', label: 'Closed' },
    ],
    value: () => (engine.state.value.parameters.closed ? 'closed' : 'open'),
    change: (value) => {
      const { closed: _, ...others } = engine.state.peek().parameters;
      engine.chooseOfFile(value === 'closed' ? { ...others, closed: 1 } : others);
    },
  });
}

/**
 * Creates the histogram above the slider of the iso value. The bars on the inner side have the colour of the slider.
 * @param {Engine} engine @param {() => number} iso
 */
export function createHistogram(engine, iso) {
  const drawn = computed(() => (engine.image.value ? barsOf(engine.image.value.histogram) : ''));
  const share = () => {
    const [min, max] = engine.image.value?.range ?? [0, 1];
    return Math.min(1, Math.max(0, (iso() - min) / (max - min)));
  };
  const side = () => (engine.field.value?.image?.is_dark_inside ? 'dark' : 'bright');
  const bars = s('svg', { viewBox: '0 0 256 1', preserveAspectRatio: 'none', 'aria-hidden': 'true' });
  return h(
    'div',
    { class: 'iso-histogram', style: { '--iso': () => share().toFixed(4) }, data: { inside: side } },
    () => {
      bars.replaceChildren(s('path', { d: drawn.value }));
      return bars;
    },
    h('i', { 'aria-hidden': 'true' }),
  );
}
