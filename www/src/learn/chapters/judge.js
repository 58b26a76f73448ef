/**
 * Two samplings that the learner judges, side by side under one camera: by eye, then by figures,
 * then with marks.
 */
import { signal } from '@preact/signals-core';
import { h, live } from '../../ui/dom.js';
import { eyeOf } from '../answers.js';
import { PAIRS } from '../judged.js';
import { createMarkKey } from '../marks.js';
import { isClosed } from '../measure.js';
import { byNeighbours, byValue, Orbit, sideBySide } from '../picture.js';
import { scoreAtEnd } from '../score.js';
import { createScorecard } from '../scorecard.js';

/** @import { Context, Score } from '../types.js' */

const LETTERS = ['A', 'B'];

/** @param {Context} context @param {keyof typeof PAIRS} which */
export async function judge({ lab, stops }, which) {
  const { stop, names, purpose, make } = PAIRS[which];
  const runs = await make(await lab);
  const orbit = new Orbit();
  const { pictures, captions, figures, point } = sideBySide(
    orbit,
    LETTERS.map((letter) => `Sampling ${letter}; both turn together`),
  );
  orbit.fitTo(runs[0].end, runs[1].end);
  orbit.faceFront(runs[0].placed);
  const isOpen = () => stops.isOpen(stop);
  /** @type {import('../../engine/types.js').Signal<readonly Score[]>} */
  const scores = signal([]);
  const scorecard = createScorecard(point);
  const box = h('div', { hidden: () => !purpose || !(isOpen() || stops.isOpen(eyeOf(stop))) }, scorecard.element);
  live(box, () => {
    const now = isOpen();
    for (const [k, run] of runs.entries()) {
      const { end } = run;
      captions[k].textContent = now ? names[k] : LETTERS[k];
      const score = scores.value[k];
      // One colour, which tells nothing of how they were made.
      const plain = byValue(end.radii, 0, 2 * end.radii[0]);
      const colours = now && score ? byNeighbours(score.valence) : plain;
      pictures[k].show({ particles: end, isClosed: isClosed(run), colours });
    }
    if (purpose && scores.value.length > 0)
      scorecard.tell(now ? names : LETTERS, scores.value, { isMarked: now, keys: [purpose] });
  });
  Promise.all(runs.map(scoreAtEnd)).then((found) => {
    scores.value = found;
  });
  return [h('div', { class: 'pair' }, figures), createMarkKey({ hidden: () => !isOpen() }), box];
}
