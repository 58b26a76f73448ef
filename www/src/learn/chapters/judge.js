/**
 * Two samplings for the learner to judge, side by side with one camera: first by eye, then by figures, then with marks.
 * The pairs at the end of the lesson are drawn at random.
 */
import { signal } from '@preact/signals-core';
import { button } from '../../ui/button.js';
import { fill, h } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { mountQuestion, seenOf } from '../ask.js';
import { reasonOf } from '../figure.js';
import { createMarkKey } from '../marks.js';
import { createPair } from '../pair.js';
import { drawable, drawn, FIGURES, OPENING, questionOf, runsOf, scoreAlike } from '../pairs.js';

/** @import { Context, Judged, Lab, ScoreFigures, Stops } from '../types.js' */

const LETTERS = ['A', 'B'];
/** Names under which the number of pairs, and the current pair, are stored. */
const [COUNT, AT] = ['judge-count', 'judge-at'];

/** The pair at the beginning, judged by eye. @param {Context} context */
export const opening = async ({ lab, stops }) => [await pairOf(await lab, OPENING, { stops, id: 'predict-first' })];

/**
 * The pictures of a pair, and its figures if there is a purpose. Names and marks come with the answer.
 * @param {Lab} lab @param {Judged} judged
 * @param {{ stops: Stops, id: string, key?: keyof ScoreFigures }} how  `id`: of the question; `key`: the
 *   figure that the purpose needs
 */
async function pairOf(lab, judged, { stops, id, key }) {
  // If one of the runs fails, the still stays.
  const runs = await runsOf(lab, judged);
  const isOpen = () => stops.isOpen(id);
  const also = /** @type {(keyof ScoreFigures)[]} */ (FIGURES.map(({ value }) => value));
  const pair = createPair(isOpen, createMarkKey({ hidden: () => !isOpen() }));
  void pair.show({
    make: async () => runs,
    labels: () => LETTERS.map((letter, k) => (isOpen() ? `${letter}, ${judged.sides[k].name}` : letter)),
    card: () =>
      key && (isOpen() || stops.isOpen(seenOf(id))) ? { names: LETTERS, isMarked: isOpen(), keys: [key], also } : null,
    score: scoreAlike,
  });
  return pair.element;
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
  /** @param {number} number @param {boolean} [isShown]  it is scrolled to */
  async function go(number, isShown = true) {
    isBusy.value = true;
    status.value = 'A pair is being drawn';
    try {
      const found = await drawn(own, drawable(await own.gallery()), series, number);
      const id = idOf(number);
      const pair = await pairOf(own, found.pair, { stops, id, key: found.purpose.key });
      const host = h('div', { class: 'predict', id }, h('div', { class: 'stage stage-pair' }, pair));
      mountQuestion(host, id, questionOf(found), { lab, stops });
      fill(place, host);
      // The card before it may have been much longer.
      if (isShown) host.scrollIntoView({ block: 'start' });
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
  if (count.peek() > 0) await go(Number(stops.more(AT)), false);
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
