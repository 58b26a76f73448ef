/** The two pairs of samplings that the learner judges: at the beginning by their pictures, at the end with figures. */
import { formatCount } from '../ui/format.js';
import { ROWS, scoreAtEnd } from './score.js';
import { isWorse, share } from './verdict.js';
import { projected } from './whatifs.js';

/** @import { Answer, Lab, LabRun, ScoreFigures } from './types.js' */

/**
 * @typedef {object} Judged
 * @property {string} stop
 * @property {readonly [string, string]} names
 * @property {keyof ScoreFigures} decides
 * @property {boolean} hasFigures  whether the figures are there, too
 * @property {(lab: Lab) => Promise<[LabRun, LabRun]>} make
 */

/** @type {Record<'first' | 'last', Judged>} */
export const PAIRS = {
  first: {
    stop: 'predict-first',
    names: ['A, a stack', 'B, a queue'],
    decides: 'six',
    hasFigures: false,
    make: async (lab) => [await lab.run({ order: 'stack' }), await lab.run({}, { keep: true })],
  },
  last: {
    stop: 'predict-last',
    names: ['A, on circles', 'B, by Newton’s method'],
    decides: 'pair',
    hasFigures: true,
    make: async (lab) => [await projected(lab, 'circle'), await projected(lab, 'newton')],
  },
};

/** Which of the first two is better: by the share with six neighbours. @param {Lab} lab @returns {Promise<Answer>} */
export async function judgeFirst(lab) {
  const [a, b] = await Promise.all((await PAIRS.first.make(lab)).map(scoreAtEnd));
  const right = isWorse(a, b) ? 'b' : isWorse(b, a) ? 'a' : 'alike';
  const words = [
    `Of the particles of B ${share(b)} have six neighbours, of those of A ${share(a)}.`,
    'A has seams all over, with holes along them. The rest of the lesson is about where seams come from, and at the end you judge again.',
  ];
  return { right, words: words.join(' ') };
}

const [, , PAIR] = ROWS;

/** Which of the last two is better: by the closest pair. @param {Lab} lab @returns {Promise<Answer>} */
export async function judgeLast(lab) {
  const runs = await PAIRS.last.make(lab);
  const [a, b] = await Promise.all(runs.map(scoreAtEnd));
  const [nearA, nearB] = [a, b].map(({ pair }) => PAIR.write(Number(pair)));
  const [countA, countB] = runs.map(({ end }) => formatCount(end.radii.length));
  const words = [
    `A has ${countA} particles and B ${countB}, and more of those of A have six neighbours. The closest pair of A is at ${nearA} of the ideal distance, that of B at ${nearB}: Newton’s method has forgotten the parent where the surface bends.`,
    'That less of the surface lies outside the discs of B says nothing, since its discs are larger.',
  ];
  return { right: Number(a.pair) > Number(b.pair) ? 'a' : 'b', words: words.join(' ') };
}
