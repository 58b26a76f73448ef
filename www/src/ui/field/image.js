/**
 * What stands below the formula for the surface of a three-dimensional image: its facts, the choice between grey values
 * and labels, the list of labels, and which voxels are inside.
 */
import { computed } from '@preact/signals-core';
import { h, s, uniqueId } from '../dom.js';
import { formatCount, formatSignificant, plural } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createWarning } from '../warning.js';
import { createWayBack } from './way-back.js';

/** @import { Description, Engine, ImageFacts, ImageInfo, ReadonlySignal } from '../../engine/types.js' */

/** Says what an image is made of. @param {ImageFacts} facts */
export function voxelsOf({ size, spacing, voxel_type, range }) {
  const steps = spacing.map((length) => formatSignificant(length)).join(' × ');
  const [min, max] = range.map((value) => formatSignificant(value, 5));
  return `${size.map(formatCount).join(' × ')} voxels of ${steps}, ${voxel_type}, ${min} to ${max}.`;
}

/** Says how the voxels were filtered, and why. @param {ImageInfo} info */
export function filteredOf({ smooth, is_smooth_chosen, label, noise }) {
  if (smooth === 0) return is_smooth_chosen ? 'There is too little noise to filter.' : '';
  const width = plural(Number(smooth.toPrecision(3)), 'voxel');
  const ofWhat = label === null ? '' : ' over the distance from the label';
  const why =
    label !== null
      ? 'against the steps between voxels'
      : noise > 0
        ? `against noise of ${formatSignificant(noise, 2)}`
        : 'against the steps between whole numbers';
  return `A Gaussian of ${width}${ofWhat}${is_smooth_chosen ? ` ${why}` : ''}: it rounds corners by about as much.`;
}

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
    h('div', { class: 'image-of', hidden: () => labels.value.length === 0 }, createKind(engine, labels, info)),
    createLabels(engine, labels, info),
    h('div', { class: 'image-of', hidden: () => info.value?.label !== null }, createSide(engine, info)),
    h('p', { class: 'quiet' }, () => info.value && filteredOf(info.value)),
    h('ul', { class: 'warnings', hidden: () => notes.value.length === 0 }, () => notes.value.map(createWarning)),
  );
  head.append(createWayBack(engine, description, section));
  return section;
}

/**
 * Creates the choice between grey values and labels.
 * @param {Engine} engine
 * @param {ReadonlySignal<ImageFacts['labels']>} labels @param {ReadonlySignal<ImageInfo | null>} info
 */
function createKind(engine, labels, info) {
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
    value: () => (info.value?.label === null ? 'iso' : 'label'),
    change: (value) => engine.chooseOfImage(value === 'label' ? { label: largest() } : {}),
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
            prop: { checked: () => info.value?.label === value },
            on: { change: () => engine.chooseOfImage({ ...kept(engine), label: value }) },
          }),
          h('span', null, formatSignificant(value, 6)),
          h('span', { class: 'quiet' }, value === 0 ? 'background, ' : '', plural(voxels, 'voxel')),
        ),
      ),
  );
}

/** What another label keeps. @param {Engine} engine @returns {Record<string, number>} */
function kept(engine) {
  const { smooth } = engine.state.peek().parameters;
  return smooth === undefined ? {} : { smooth };
}

/** Creates the choice of the side. @param {Engine} engine @param {ReadonlySignal<ImageInfo | null>} info */
function createSide(engine, info) {
  return createSegmented({
    name: 'Inside',
    choices: [
      { value: 'bright', label: 'Bright inside' },
      { value: 'dark', label: 'Dark inside' },
    ],
    value: () => (info.value?.is_dark_inside ? 'dark' : 'bright'),
    change: (value) => {
      const { dark: _, ...others } = engine.state.peek().parameters;
      engine.chooseOfImage(value === 'dark' ? { ...others, dark: 1 } : others);
    },
  });
}

/**
 * Creates the histogram above the slider of the iso value. The bars on the inner side are in the colour of the slider.
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

/**
 * The bars of a histogram as a path. Their heights are logarithms: most voxels are of the background.
 * @param {number[]} counts
 */
export function barsOf(counts) {
  const highest = Math.log1p(Math.max(...counts, 1));
  return counts
    .map((count, k) => (count > 0 ? `M${k} 1V${+(1 - Math.log1p(count) / highest).toFixed(3)}h1V1z` : ''))
    .join('');
}
