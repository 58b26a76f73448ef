/** The pairs of samplings that the learner judges: at the beginning by their pictures, at the end with figures. */
import { scoreAtEnd, verdictOf } from './score.js';
import { written } from './verdict.js';

/** @import { FormulaSurface } from '../ui/types.js' */
/** @import { Answer, Lab, LabRun, Score } from './types.js' */

/**
 * @typedef {object} Judged
 * @property {string} stop
 * @property {readonly [string, string]} names
 * @property {boolean} hasFigures  whether the figures are there, too
 * @property {(lab: Lab) => Promise<[LabRun, LabRun]>} make
 * @property {(scores: readonly Score[]) => string[]} words  why one is better, or neither
 */

/** A surface that the learner has not seen before. @type {FormulaSurface} */
export const TORUS = {
  formula: '(sqrt(x^2 + y^2) - 0.7)^2 + z^2 = 0.09',
  parameters: [],
  bounds: { min: [-1.2, -1.2, -0.5], max: [1.2, 1.2, 0.5] },
};

/** @type {Record<'first' | 'weigh' | 'chance', Judged>} */
export const PAIRS = {
  first: {
    stop: 'predict-first',
    names: ['A, a stack', 'B, a queue'],
    hasFigures: false,
    make: async (lab) => [await lab.run({ order: 'stack' }), await lab.run({}, { keep: true })],
    words: ([a, b]) => [
      `Of the particles of B ${written('six', b)} have six neighbours, of those of A ${written('six', a)}.`,
      'A has seams all over, with holes along them. The rest of the lesson is about where seams come from, and at the end you judge again.',
    ],
  },
  weigh: {
    stop: 'predict-last',
    names: ['A, a stack after ten steps', 'B, a queue before any'],
    hasFigures: true,
    make: async (lab) => {
      const own = lab.on(TORUS);
      return [await own.run({ order: 'stack' }), await own.run({ relax_steps: 0 })];
    },
    words: ([a, b]) => [
      `The largest hole and the closest pair speak for A. But ${written('six', b)} of B have six neighbours, and ${written('six', a)} of A, a difference beyond chance; so order decides.`,
      'Ten steps of relaxation would shrink the hole of B. They cannot give A the order that its seams have cost.',
    ],
  },
  chance: {
    stop: 'predict-chance',
    names: ['A, seed 1', 'B, seed 3'],
    hasFigures: true,
    make: async (lab) => {
      const own = lab.on(TORUS);
      return [await own.run({ seed: 1 }), await own.run({ seed: 3 })];
    },
    words: () => [
      'No figure differs by more than chance. Both are the sampling of the lesson, from two seeds: what differs is where the front began.',
    ],
  },
};

/**
 * Which of a pair is better.
 * @param {Lab} lab @param {keyof typeof PAIRS} which
 * @returns {Promise<Answer>}
 */
export async function judgePair(lab, which) {
  const { make, words } = PAIRS[which];
  const scores = await Promise.all((await make(lab)).map(scoreAtEnd));
  const verdict = verdictOf(scores);
  return { right: verdict ? ['a', 'b'][verdict.side] : 'alike', words: words(scores).join(' ') };
}
