/**
 * The three figures by which samplings are judged, in a patch of sampling B from the beginning, and how they vary with
 * the seed: five runs as dots, whose spread is chance.
 */
import { signal } from '@preact/signals-core';
import { clamp } from '../../engine/vector.js';
import { label, line, ring } from '../../figures/svg.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatCount, formatFixed } from '../../ui/format.js';
import { offerNumber } from '../drag.js';
import { NoSurface } from '../lab.js';
import { latest } from '../latest.js';
import { createMarkKey } from '../marks.js';
import { fromSeed, SEEDS } from '../pairs.js';
import { HALF, patchOf } from '../patch.js';
import { chanceOf, DECIDING, rowOf, scoreAtEnd, widthOf, written } from '../score.js';

/** @import { Context, LabRun, Score } from '../types.js' */

/** @param {Context} context */
export async function measures({ lab }) {
  const own = await lab;
  /** The runs so far, by seed. @type {{ run: LabRun, score: Score }[]} */
  const all = [];
  /** @type {import('../../engine/types.js').Signal<readonly Score[]>} */
  const scores = signal([]);
  /** The seed shown. */
  const at = signal(0);
  const isBusy = signal(false);
  /** Makes the run of a seed, and those before it. @param {number} seed */
  async function make(seed) {
    while (all.length <= seed) {
      const run = await fromSeed(own, all.length);
      all.push({ run, score: await scoreAtEnd(run) });
    }
    scores.value = all.map(({ score }) => score);
    at.value = seed;
  }
  const show = latest(async (/** @type {number} */ seed) => {
    isBusy.value = true;
    try {
      await make(seed);
    } finally {
      isBusy.value = false;
    }
  });
  await make(0);
  const box = h('div', { class: 'drawing-box' });
  live(box, () => fill(box, drawingOf(all[at.value].run, all[at.value].score)));
  const isOver = () => scores.value.length >= SEEDS;
  const side = h(
    'div',
    { class: 'side' },
    createMarkKey(),
    h('p', null, 'Of the whole sampling, a dot for each run:'),
    h('div', { class: 'dots' }, () => DECIDING.map((key) => dotsOf(key, scores.value, at.value))),
    h(
      'div',
      { class: 'controls' },
      button({ hidden: isOver, disabled: () => isBusy.value, press: () => void show(scores.peek().length) }, () =>
        isBusy.value ? 'It begins elsewhere' : 'Another seed',
      ),
    ),
    h('p', { class: 'told', 'aria-live': 'polite' }, () =>
      isOver()
        ? `One method on one surface: only the place where it began differs, and the dots lie up to ${listOf(DECIDING.map((key) => widthWords(key, scores.value)))} apart. The pale bands are as wide as chance can be.`
        : `Run ${scores.value.length} of ${SEEDS}.`,
    ),
  );
  offerNumber('seed', {
    name: 'Seed',
    scale: { min: 1, max: SEEDS, step: 1 },
    value: () => at.value + 1,
    say: formatCount,
    stage: () => box.closest('.stage'),
    change: (number) => void show(number - 1),
  });
  return [h('div', { class: 'two' }, box, side)];
}

/** @param {readonly string[]} all */
const listOf = (all) => `${all.slice(0, -1).join(', ')} and ${all.at(-1)}`;

/** @param {typeof DECIDING[number]} key @param {readonly Score[]} scores */
function widthWords(key, scores) {
  const { write, writeChance = write } = rowOf(key);
  return writeChance(widthOf(key, scores));
}

/** Half the width of an axis, divided by the width called chance. */
const ROOM = 1.25;

/**
 * The values of a figure in several runs as dots, centred on the first run. The band behind them is as wide as what the
 * tables call chance.
 * @param {typeof DECIDING[number]} key @param {readonly Score[]} scores @param {number} shown  number of the run
 */
function dotsOf(key, scores, shown) {
  const row = rowOf(key);
  const chance = Number(chanceOf(row, scores));
  const at = (/** @type {Score} */ score) =>
    clamp(0.5 + (Number(score[key]) - Number(scores[0][key])) / (2 * ROOM * chance), 0, 1);
  const values = scores.map((score) => written(key, score));
  return h(
    'div',
    { class: 'dots-row' },
    h('span', null, row.name),
    h('b', null, values[shown]),
    h(
      'div',
      { class: 'dots-axis', role: 'img', 'aria-label': `${row.name}: ${values.join(', ')}` },
      scores.map((score, k) =>
        h('span', { class: k === shown ? 'now' : null, style: { left: `${100 * at(score)}%` } }),
      ),
    ),
  );
}

/** @param {LabRun} run @param {Score} score */
function drawingOf(run, score) {
  const patch = patchOf(run, score);
  if (!patch) throw new NoSurface('The surface leaves no hole that can be measured.');
  const { width, height } = HALF;
  const svg = s('svg', {
    class: 'drawing patch',
    viewBox: `${-width} ${-height} ${2 * width} ${2 * height}`,
    role: 'img',
    'aria-label': `A patch of the sampling with the cells of its particles, those with five and with seven neighbours marked. The largest empty circle has the radius ${formatFixed(patch.hole, 2)} r.`,
  });
  for (const { at, cell, valence } of patch.seen) {
    const kind = valence === 6 || valence === 0 ? '' : valence < 6 ? ' five' : ' seven';
    svg.append(ring(`disc${kind}`, at, 1), line('cell', [...cell, cell[0]]));
  }
  for (const { at } of patch.seen) svg.append(ring('centre', at, 0.1));
  svg.append(ring('hole', [0, 0], patch.hole), line('pair', patch.pair));
  const [[x, y], [u, v]] = patch.pair;
  svg.append(label('name', [0, 0], 'hole'), label('name', [(x + u) / 2 + 0.7, (y + v) / 2 - 0.1], 'pair'));
  return svg;
}
