/** Two samplings that the learner judges, side by side under one camera. */
import { h, live } from '../../ui/dom.js';
import { PAIRS } from '../judged.js';
import { byValue, Orbit, sideBySide } from '../picture.js';
import { scoreAtEnd } from '../score.js';
import { createScorecard } from '../scorecard.js';

/** @import { Context, Score } from '../types.js' */

/** @param {Context} context @param {keyof typeof PAIRS} which */
export async function judge({ lab, stops }, which) {
  const { stop, names, hasFigures, make } = PAIRS[which];
  const runs = await make(await lab);
  const orbit = new Orbit();
  const letters = ['A', 'B'];
  const { pictures, captions, figures, point } = sideBySide(
    orbit,
    letters.map((letter) => `Sampling ${letter}; both turn together`),
  );
  orbit.fitTo(runs[0].end, runs[1].end);
  orbit.faceFront(runs[0].placed);
  // One colour, which tells nothing of how they were made.
  for (const [k, { end }] of runs.entries())
    pictures[k].show({ particles: end, colours: byValue(end.radii, 0, 2 * end.radii[0]) });
  const scorecard = createScorecard(point);
  const isOpen = () => stops.isOpen(stop);
  const box = h('div', { hidden: !hasFigures }, scorecard.element);
  /** @type {Score[]} */
  let scores = [];
  live(box, () => {
    const now = isOpen();
    for (const [k, caption] of captions.entries()) caption.textContent = now ? names[k] : letters[k];
    if (!hasFigures) return;
    const tell = () => scorecard.tell(now ? names : letters, scores, { isMarked: now });
    if (scores.length > 0) return tell();
    Promise.all(runs.map(scoreAtEnd)).then((found) => {
      scores = found;
      if (isOpen() === now) tell();
    });
  });
  return [h('div', { class: 'pair' }, figures), box];
}
