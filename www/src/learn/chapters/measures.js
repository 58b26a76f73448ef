/**
 * The three figures by which samplings are judged, in a patch of sampling B of the beginning, and what
 * another seed does to them: five runs as dots, whose width is chance.
 */
import { signal } from '@preact/signals-core';
import { clamp } from '../../engine/vector.js';
import { label, line, ring } from '../../figures/svg.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatFixed } from '../../ui/format.js';
import { NoSurface } from '../lab.js';
import { createMarkKey } from '../marks.js';
import { fromSeed, SEEDS } from '../pairs.js';
import { HALF, patchOf } from '../patch.js';
import { chanceOf, DECIDING, rowOf, scoreAtEnd, widthOf, written } from '../score.js';

/** @import { Context, LabRun, Score } from '../types.js' */

/** @param {Context} context */
export async function measures({ lab }) {
  const own = await lab;
  const run = await fromSeed(own, 0);
  const first = await scoreAtEnd(run);
  const shown = signal({ run, score: first });
  /** Those of the runs so far. @type {import('../../engine/types.js').Signal<readonly Score[]>} */
  const scores = signal([first]);
  const isBusy = signal(false);
  const box = h('div', { class: 'drawing-box' });
  live(box, () => fill(box, drawingOf(shown.value.run, shown.value.score)));
  async function again() {
    isBusy.value = true;
    try {
      const next = await fromSeed(own, scores.peek().length);
      const score = await scoreAtEnd(next);
      scores.value = [...scores.peek(), score];
      shown.value = { run: next, score };
    } finally {
      isBusy.value = false;
    }
  }
  const isOver = () => scores.value.length >= SEEDS;
  const side = h(
    'div',
    { class: 'side' },
    createMarkKey(),
    h('p', null, 'Of the whole sampling, a dot for each run:'),
    h('div', { class: 'dots' }, () => DECIDING.map((key) => dotsOf(key, scores.value))),
    h(
      'div',
      { class: 'controls' },
      button({ hidden: isOver, disabled: () => isBusy.value, press: () => void again() }, () =>
        isBusy.value ? 'It begins elsewhere' : 'Another seed',
      ),
    ),
    h('p', { class: 'told', 'aria-live': 'polite' }, () =>
      isOver()
        ? `One method on one surface: only the place where it began differs. The dots are ${DECIDING.map((key) => widthWords(key, scores.value)).join(', ')} wide. That width is chance.`
        : `Run ${scores.value.length} of ${SEEDS}.`,
    ),
  );
  return [h('div', { class: 'two' }, box, side)];
}

/** @param {typeof DECIDING[number]} key @param {readonly Score[]} scores */
function widthWords(key, scores) {
  const { write, writeChance = write } = rowOf(key);
  return writeChance(widthOf(key, scores));
}

/** Half the width of an axis, over what is called chance. */
const ROOM = 1.25;

/**
 * A figure of several runs as dots, around the first. The band behind them is as wide as what
 * tables call chance.
 * @param {typeof DECIDING[number]} key @param {readonly Score[]} scores
 */
function dotsOf(key, scores) {
  const row = rowOf(key);
  const chance = Number(chanceOf(row, scores));
  const at = (/** @type {Score} */ score) =>
    clamp(0.5 + (Number(score[key]) - Number(scores[0][key])) / (2 * ROOM * chance), 0, 1);
  const values = scores.map((score) => written(key, score));
  return h(
    'div',
    { class: 'dots-row' },
    h('span', null, row.name),
    h('b', null, values[values.length - 1]),
    h(
      'div',
      { class: 'dots-axis', role: 'img', 'aria-label': `${row.name}: ${values.join(', ')}` },
      scores.map((score, k) =>
        h('span', { class: k === scores.length - 1 ? 'now' : null, style: { left: `${100 * at(score)}%` } }),
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
