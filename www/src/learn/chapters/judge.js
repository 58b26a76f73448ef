/**
 * Two samplings for the learner to judge, side by side with one camera: first by eye, then by figures, then with marks.
 * The pairs at the end of the lesson are drawn at random.
 */
import { signal } from '@preact/signals-core';
import { button } from '../../ui/button.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { mountQuestion, seenOf } from '../ask.js';
import { reasonOf } from '../figure.js';
import { createMarkKey } from '../marks.js';
import { isClosed } from '../measure.js';
import { drawable, drawn, FIGURES, OPENING, questionOf, runsOf, scoresOf } from '../pairs.js';
import { byNeighbours, byValue, Orbit, sideBySide } from '../picture.js';
import { createScorecard } from '../scorecard.js';

/** @import { Context, Judged, Lab, Score, ScoreFigures, Stops } from '../types.js' */

const LETTERS = ['A', 'B'];
/** Names under which the number of pairs, and the current pair, are stored. */
const [COUNT, AT] = ['judge-count', 'judge-at'];

/** The pair at the beginning, judged by eye. @param {Context} context */
export const opening = async ({ lab, stops }) => picturesOf(await lab, OPENING, { stops, id: 'predict-first' });

/**
 * The pictures of a pair, and its figures if there is a purpose.
 * @param {Lab} lab @param {Judged} pair
 * @param {{ stops: Stops, id: string, key?: keyof ScoreFigures }} how  `id`: of the question; `key`: the
 *   figure that the purpose needs
 */
async function picturesOf(lab, pair, { stops, id, key }) {
  const runs = await runsOf(lab, pair);
  const orbit = new Orbit();
  const { pictures, captions, figures, point } = sideBySide(
    orbit,
    LETTERS.map((letter) => `Sampling ${letter}; both turn together`),
  );
  orbit.fitTo(runs[0].end, runs[1].end);
  orbit.faceFront(runs[0].placed);
  const isOpen = () => stops.isOpen(id);
  /** @type {import('../../engine/types.js').Signal<readonly Score[]>} */
  const scores = signal([]);
  const scorecard = createScorecard(point);
  const box = h('div', { hidden: () => !key || !(isOpen() || stops.isOpen(seenOf(id))) }, scorecard.element);
  live(box, () => {
    const now = isOpen();
    const names = LETTERS.map((letter, k) => (now ? `${letter}, ${pair.sides[k].name}` : letter));
    for (const [k, run] of runs.entries()) {
      const { end } = run;
      captions[k].textContent = names[k];
      const score = scores.value[k];
      // A single colour, which tells nothing about the method.
      const plain = byValue(new Float32Array(end.radii.length).fill(1), 0, 2);
      const colours = now && score ? byNeighbours(score.valence) : plain;
      pictures[k].show({ particles: end, isClosed: isClosed(run), colours });
    }
    const also = /** @type {(keyof ScoreFigures)[]} */ (FIGURES.map(({ value }) => value));
    if (key && scores.value.length > 0) scorecard.tell(names, scores.value, { isMarked: now, keys: [key], also });
  });
  scoresOf(lab, pair).then(
    (found) => {
      scores.value = found;
    },
    (error) => box.append(h('p', { class: 'figure-status' }, reasonOf(error))),
  );
  return [h('div', { class: 'pair' }, figures), createMarkKey({ hidden: () => !isOpen() }), box];
}

/** Random pairs, one after the other, on request. @param {Context} context */
export async function draws({ lab, stops, series }) {
  const own = await lab;
  const place = h('div', { 'aria-live': 'polite' });
  /** Number of the pair shown; −1 before the first. */
  const at = signal(-1);
  const count = signal(Number(stops.more(COUNT) ?? 0));
  const status = signal('');
  const isBusy = signal(false);
  /** @param {number} number */
  async function go(number) {
    isBusy.value = true;
    status.value = 'A pair is being drawn';
    try {
      const found = await drawn(own, drawable(await own.gallery()), series, number);
      const id = idOf(number);
      const pictures = await picturesOf(own, found.pair, { stops, id, key: found.purpose.key });
      const host = h('div', { class: 'predict', id }, h('div', { class: 'stage stage-pair' }, pictures));
      mountQuestion(host, id, questionOf(found), { lab, stops });
      fill(place, host);
      at.value = number;
      count.value = Math.max(count.peek(), number + 1);
      stops.keepMore(AT, number);
      stops.keepMore(COUNT, count.peek());
      status.value = '';
    } catch (error) {
      status.value = reasonOf(error);
    } finally {
      isBusy.value = false;
    }
  }
  const turn = (
    /** @type {string | (() => string)} */ words,
    /** @type {1 | -1} */ by,
    /** @type {() => boolean} */ hidden,
  ) =>
    button(
      {
        class: by < 0 ? 'plain' : null,
        hidden,
        disabled: () => isBusy.value,
        press: () => void go(at.peek() + by),
      },
      words,
    );
  if (count.peek() > 0) await go(Number(stops.more(AT)));
  return [
    h(
      'p',
      { class: 'quiet', hidden: () => at.value < 0 },
      () => `Pair ${formatCount(at.value + 1)}. ${tallyOf(stops, count.value)}`,
    ),
    place,
    h(
      'div',
      { class: 'controls' },
      turn('The pair before', -1, () => at.value < 1),
      turn(
        () => (at.value < 0 ? 'Draw a pair' : 'Another pair'),
        1,
        () => false,
      ),
      h('span', { role: 'status' }, () => status.value),
    ),
  ];
}

/** @param {number} number */
const idOf = (number) => `judge-${number + 1}`;

/** How many guesses have been right. @param {Stops} stops @param {number} count of pairs */
function tallyOf(stops, count) {
  // A pair from an earlier visit opens when it is shown again; its guesses were stored.
  const isJudged = (/** @type {string} */ id) => stops.isOpen(id) || stops.outcomes.has(`${id}-eye`);
  const judged = Array.from({ length: count }, (_, number) => idOf(number)).filter(isJudged);
  if (judged.length === 0) return '';
  const right = (/** @type {string[]} */ ...parts) =>
    judged.filter((id) =>
      parts.every((part) => {
        const { guess = null, right: wanted } = stops.outcomes.get(`${id}-${part}`) ?? {};
        return guess !== null && guess === wanted;
      }),
    ).length;
  const of = `of ${plural(judged.length, 'pair')}`;
  return `Right by eye: ${right('eye')} ${of}; by the figures: ${right('figure', 'winner')}.`;
}
