/**
 * The pairs of samplings that the learner judges: the first by eye, the last ones by eye and then
 * by their figures.
 */
import { formatCount } from '../ui/format.js';
import { chanceOf, DECIDING, rowOf, scoreAtEnd, verdictOf } from './score.js';
import { subjectOf } from './surface.js';
import { written } from './verdict.js';

/** @import { FormulaSurface } from '../ui/types.js' */
/** @import { Answer, Lab, LabRun, Score } from './types.js' */

/** @typedef {typeof DECIDING[number]} Deciding */
/**
 * @typedef {object} Judged
 * @property {string} stop
 * @property {readonly [string, string]} names
 * @property {Deciding} [purpose]  the figure that the purpose asks for; none where it is judged by eye alone
 * @property {(lab: Lab) => Promise<[LabRun, LabRun]>} make
 * @property {(scores: readonly Score[]) => string[]} words  why one is better, or neither
 */

/** A surface that the learner has not seen before. @type {FormulaSurface} */
export const TORUS = {
  formula: '(sqrt(x^2 + y^2) - 0.7)^2 + z^2 = 0.09',
  parameters: [],
  bounds: { min: [-1.2, -1.2, -0.5], max: [1.2, 1.2, 0.5] },
};
/** What chance makes in the share with six neighbours. @param {readonly Score[]} scores */
const chanceWords = (scores) => rowOf('six').writeChance?.(Number(chanceOf(rowOf('six'), scores)));

/** Particles of the pair with few. */
const FEW = 200;

/** @type {Record<'first' | 'weigh' | 'few' | 'chance', Judged>} */
export const PAIRS = {
  first: {
    stop: 'predict-first',
    names: ['A', 'B'],
    make: async (lab) => [await lab.run({ order: 'stack' }), await lab.run({}, { keep: true })],
    words: ([a, b]) => [
      `Of the particles of B ${written('six', b)} have six neighbours, of those of A ${written('six', a)}: the coloured ones have more or fewer.`,
      Number(a.count) < Number(b.count)
        ? `A leaves more of the surface bare, but only because it has fewer discs, ${formatCount(a.count)} against ${formatCount(b.count)}.`
        : '',
    ],
  },
  weigh: {
    stop: 'predict-last',
    names: ['A, a stack, relaxed', 'B, a queue, not relaxed'],
    purpose: 'six',
    make: async (lab) => {
      const own = lab.on(TORUS);
      return [await own.run({ order: 'stack' }), await own.run({ relax_steps: 0 })];
    },
    words: ([a, b]) => [
      `The pattern is regular where particles have six neighbours: ${written('six', b)} against ${written('six', a)}, and chance makes ${chanceWords([a, b])}.`,
      'For the two other purposes A would be the better one, by a smaller hole and a wider closest pair.',
    ],
  },
  few: {
    stop: 'predict-few',
    names: ['A, a queue, not relaxed', 'B, a stack, relaxed'],
    purpose: 'hole',
    make: async (lab) => {
      const own = lab.on(subjectOf(undefined).surface);
      return [
        await own.run({ relax_steps: 0, seed: 3 }, { particles: FEW }),
        await own.run({ order: 'stack', seed: 2 }, { particles: FEW }),
      ];
    },
    words: ([a, b]) => [
      `A part of the surface can hide in the largest hole: ${written('hole', a)} in A against ${written('hole', b)} in B.`,
      `The ${written('six', a)} of A with six neighbours look better than the ${written('six', b)} of B, but with so few particles chance makes ${chanceWords([a, b])}.`,
    ],
  },
  chance: {
    stop: 'predict-chance',
    names: ['A, seed 1', 'B, seed 3'],
    purpose: 'pair',
    make: async (lab) => {
      const own = lab.on(TORUS);
      return [await own.run({ seed: 1 }), await own.run({ seed: 3 })];
    },
    words: ([a, b]) => [
      `The closest pair is the shortest edge of the mesh: ${written('pair', a)} against ${written('pair', b)}, which may be chance.`,
      'Both are one method on one torus. Only the seed differs, the place where the front began.',
    ],
  },
};

/**
 * Which of a pair is better, and by which figure.
 * @param {Lab} lab @param {keyof typeof PAIRS} which
 * @returns {Promise<Answer>}
 */
export async function judgePair(lab, which) {
  const { make, words, purpose } = PAIRS[which];
  const scores = await Promise.all((await make(lab)).map(scoreAtEnd));
  const verdict = verdictOf(scores, purpose ? [purpose] : DECIDING);
  const eye = verdict ? ['a', 'b'][verdict.side] : 'alike';
  return { right: purpose ? (verdict?.key ?? 'alike') : eye, eye, words: words(scores).join(' ') };
}
