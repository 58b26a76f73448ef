/** The questions of the lesson: how each is answered by the run. */

import { distance, triple } from '../engine/vector.js';
import { inRadii } from '../figures/words.js';
import { formatCount, formatFixed, formatSignificant, plural } from '../ui/format.js';
import { adaptiveRun } from './adaptive.js';
import { asFineEverywhere, costOf, openBend, RING, ringsOf, scoresOfRest, widestHole } from './measure.js';
import { verdictOf } from './score.js';
import { written } from './verdict.js';

/** @import { Prediction } from './types.js' */

/** Two amounts that differ by less than this factor are called alike. */
const ALIKE = 1.25;
/** A guess within this share of the number is close. */
const CLOSE = 0.1;
/** Distances below this share of 2r are called nearer. */
const NEARER = 0.999;

/** @type {NonNullable<Prediction['judge']>} */
const judgeNumber = (guess, right) => {
  if (guess === right) return 'Exactly.';
  const far = Math.abs(Number(guess) - Number(right));
  return far <= Math.max(1, CLOSE * Number(right)) ? 'Close.' : `You said ${formatCount(guess)}.`;
};

/** The lower ends of the answers to the last question. */
const FACTORS = [1.3, 2, 4];
/** Below this factor all sizes are called alike. */
const EVEN = 1.05;

/** Two samplings beside each other. */
const BY_EYE = [
  { value: 'a', label: 'Sampling A' },
  { value: 'b', label: 'Sampling B' },
  { value: 'alike', label: 'They cannot be told apart' },
];

/** @param {'first' | 'weigh' | 'few' | 'chance'} which @returns {Prediction['answer']} */
const judging = (which) => async (lab) => (await import('./judged.js')).judgePair(lab, which);

/**
 * A pair that is judged by eye, and then by its figures.
 * @param {'weigh' | 'few' | 'chance'} which
 * @param {readonly string[]} sides  that are better by six neighbours, hole and pair, be it by chance
 * @returns {Prediction}
 */
const judged = (which, [six, hole, pair]) => ({
  kind: 'choice',
  eye: BY_EYE,
  choices: [
    { value: 'six', label: `${six}, by six neighbours` },
    { value: 'hole', label: `${hole}, by the largest hole` },
    { value: 'pair', label: `${pair}, by the closest pair` },
    BY_EYE[2],
  ],
  answer: judging(which),
});

/** By the id of the question in the page's markup. @type {Record<string, Prediction>} */
export const PREDICTIONS = {
  'predict-first': { kind: 'choice', choices: BY_EYE, answer: judging('first') },
  'predict-last': judged('weigh', ['B', 'A', 'A']),
  'predict-few': judged('few', ['A', 'B', 'B']),
  'predict-chance': judged('chance', ['B', 'A', 'B']),
  'predict-cost': {
    kind: 'choice',
    choices: [
      { value: 'placing', label: 'Placing all particles' },
      { value: 'alike', label: 'Both about the same' },
      { value: 'resting', label: 'The ten steps of relaxation' },
    ],
    async answer(lab) {
      const { rows } = await costOf(lab);
      const [placing, resting] = rows.map(({ evaluations }) => evaluations);
      const right = placing > ALIKE * resting ? 'placing' : resting > ALIKE * placing ? 'resting' : 'alike';
      const [one, ten, pushes] = [placing, resting, rows[1].pushes].map((count) => formatSignificant(count, 3));
      const words = [
        `Placing took ${one} evaluations of f for each particle, the ten steps ${ten}.`,
        `In seconds the steps cost far more: 82 to 96 % of the time in the paper’s Table 2. Besides asking f they sum pushes, ${pushes} for each particle here.`,
      ];
      return { right, words: words.join(' ') };
    },
  },
  'predict-children': {
    kind: 'number',
    label: 'New children, 0 to 6',
    most: 6,
    answer: async (lab) => (await import('./decisions.js')).childrenOf(lab),
    judge: judgeNumber,
  },
  'predict-newton': {
    kind: 'choice',
    choices: [
      { value: 'nearer', label: 'Nearer than 2r' },
      { value: 'same', label: 'At 2r' },
      { value: 'farther', label: 'Farther than 2r' },
    ],
    async answer(lab) {
      const { profile, opened, whole, slot } = await openBend(lab);
      const { radius } = opened.subject;
      const landed = whole.children[slot].landed?.distance ?? 2 * radius;
      const own = profile?.newtonDistance ?? null;
      if (own === null) return { right: 'none', words: 'Here Newton’s method lands nowhere near. The circle does.' };
      const share = own / (2 * radius);
      const right = share < NEARER ? 'nearer' : share > 1 / NEARER ? 'farther' : 'same';
      return {
        right,
        words: `Newton’s method lands at ${inRadii(own, radius)}, the circle at ${inRadii(landed, radius)}. It goes down the gradient and knows nothing of the parent: the open circle in the drawing is its landing.`,
      };
    },
  },
  'predict-ring': {
    kind: 'number',
    label: 'Particles in ring 12',
    async answer(lab) {
      const rings = ringsOf((await lab.run({}, { keep: true })).placed);
      const level = Math.min(RING, rings.length - 1);
      const count = rings[level];
      const reason =
        count === 6 * level
          ? 'The bars below the picture follow 6k, as in a plane.'
          : count < 6 * level
            ? 'The surface closes around the seed and takes room from the rings: the bars below the picture fall behind 6k.'
            : 'The surface bends like a saddle around the seed, which gives the rings more room: the bars below the picture run ahead of 6k.';
      const words = `Ring ${level} of this surface has ${plural(count, 'particle')}; on a plane it would have ${6 * level}. ${reason}`;
      return { right: count, words };
    },
    judge: judgeNumber,
  },
  'predict-hole': {
    kind: 'pick',
    async answer(lab, guess) {
      const widest = await widestHole(lab);
      if (!widest) return { right: -1, words: 'On this surface the rings leave no hole wide enough to count.' };
      const { placed } = widest.run;
      const level = placed.levels[widest.particle];
      const last = placed.levels.reduce((most, own) => Math.max(most, own), 0);
      const words = `The widest hole is in the ring of the picture, beside a particle of level ${level} of ${last}: on a seam, where parts of the front have met and left less room than a particle needs.`;
      if (typeof guess !== 'number') return { right: widest.particle, words };
      const far = distance(triple(placed.positions, guess), widest.hole.places[0]) / (2 * widest.radius);
      return {
        right: widest.particle,
        words: `${words} You pressed ${formatFixed(far, 1)} particle distances away from it.`,
      };
    },
    judge: (guess, right) => (guess === right ? 'Exactly there.' : ''),
  },
  'predict-rest': {
    kind: 'choice',
    choices: [
      { value: 'hole', label: 'The largest hole' },
      { value: 'six', label: 'The share with six neighbours' },
      { value: 'both', label: 'Both' },
      { value: 'neither', label: 'Neither' },
    ],
    async answer(lab) {
      const [before, after] = await scoresOfRest(lab);
      const changed = (/** @type {'hole' | 'six'} */ key) => verdictOf([before, after], [key]) !== null;
      const right = changed('hole') ? (changed('six') ? 'both' : 'hole') : changed('six') ? 'six' : 'neither';
      const [hole, six] = /** @type {const} */ (['hole', 'six']).map((key) =>
        [before, after].map((score) => written(key, score)),
      );
      const words = [
        `The largest hole was ${hole[0]} and is ${hole[1]}; ${six[0]} had six neighbours and ${six[1]} have.`,
        'Pushes even out the room that there is: those around a hole move in. For another neighbour whole rows would have to slip past each other, and hardly any does.',
      ];
      return { right, words: words.join(' ') };
    },
  },
  'predict-sizes': {
    kind: 'choice',
    choices: [
      { value: '0', label: 'About the same number' },
      { value: '1', label: 'Up to twice the number' },
      { value: '2', label: 'Two to four times the number' },
      { value: '3', label: 'More than that' },
    ],
    async answer(lab) {
      const { end } = await adaptiveRun(lab, 'max_curvature');
      const [count, wanted] = [end.radii.length, asFineEverywhere(end.radii)];
      const factor = wanted / count;
      const at = FACTORS.findIndex((limit) => factor < limit);
      if (factor < EVEN)
        return {
          right: '0',
          words:
            'On this surface the stronger curvature is nearly the same everywhere, and so are the radii. Nothing is saved here.',
        };
      const words = [
        `Here ${plural(count, 'particle')} follow the curvature. All as small as the smallest of them, they would be`,
        `about ${formatCount(wanted)}, ${formatSignificant(factor, 2)} times as many: the sharpest bend, where the picture has its smallest discs, would rule the flat parts, too.`,
      ];
      return { right: String(at < 0 ? FACTORS.length : at), words: words.join(' ') };
    },
  },
  'predict-moving': {
    kind: 'choice',
    choices: [
      { value: 'count', label: 'The number: there are too few' },
      { value: 'holes', label: 'The cover: holes open' },
      { value: 'order', label: 'The order: fewer have six neighbours' },
      { value: 'nothing', label: 'Nothing of this' },
    ],
    answer: async (lab) => (await import('./flowing.js')).lossOf(lab),
  },
};
