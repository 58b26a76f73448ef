/**
 * The questions of the lesson as data: the question, the measurement for the answer, the right answer, and the words
 * about it. `ask.js` uses them.
 */
import { inRadii } from '../figures/words.js';
import { formatCount, formatFixed, formatSignificant, plural } from '../ui/format.js';
import { adaptiveRun } from './adaptive.js';
import { childrenOf } from './decisions.js';
import { asFineEverywhere, costOf, firstSeamOf, openBend, RING, ringsOf, scoresOfRest } from './measure.js';
import { FIGURES, OPENING, PLAIN_SIDES, SIDES, scoresOf, winnerOf } from './pairs.js';
import { verdictOf, written } from './score.js';

/** @import { Part, Question, Score } from './types.js' */

/** Distances below this share of 2r are called nearer. */
const NEARER = 0.999;
/** Lower ends of the answers to the question about sizes; below the first, all sizes are called alike. */
const FACTORS = [1.05, 1.3, 2, 4];

/**
 * The rings that the question about seams offers; −1 for none.
 * @type {Record<string, (rings: readonly number[]) => number>}
 */
const OFFERED = {
  six: (rings) => rings.findIndex((count, k) => k > 0 && count !== 6 * k),
  first: () => 1,
  longest: (rings) => rings.indexOf(Math.max(...rings)),
  last: ({ length }) => length - 1,
};

/** @param {Record<string, string>} labels  by their values */
const choices = (labels) => Object.entries(labels).map(([value, label]) => ({ value, label }));

/**
 * A question with one part.
 * @template F
 * @param {Omit<Question<F>, 'rounds'> & Omit<Part<F>, 'name'>} about
 * @returns {Question<any>}
 */
const one = ({ question, ask, words, ...part }) => ({ question, ask, words, rounds: [[{ name: '', ...part }]] });

/** By the id of the question in the page's markup. @type {Record<string, Question<any>>} */
export const QUESTIONS = {
  'predict-first': one({
    question: 'Two samplings of a torus, with discs of one size. Which is the more regular pattern?',
    kind: 'choice',
    choices: PLAIN_SIDES,
    ask: (lab) => scoresOf(lab, OPENING),
    right: (/** @type {Score[]} */ scores) => winnerOf(scores, 'six'),
    words: ([a, b]) => [
      `In B ${written('six', b)} of the particles have exactly six neighbours, in A ${written('six', a)}: the coloured ones have more or fewer.`,
      'A looks more even, since it was relaxed: its particles were pushed apart until their gaps were alike. B was not.',
    ],
  }),
  'predict-children': one({
    question: 'Six new particles fit around A. For how many new ones is there room around B, the first of them?',
    kind: 'number',
    label: 'New particles, 0 to 6',
    most: 6,
    ask: childrenOf,
    right: ({ added }) => added,
    words: ({ added, matched }) => [
      `One place around B holds A, and ${formatCount(matched)} hold particles that A has placed beside B: there is room for ${formatCount(added)}.`,
      'In the figure B has its turn now.',
    ],
  }),
  'predict-ring': one({
    question: 'How many particles has ring 12 on this surface?',
    kind: 'number',
    label: 'Particles in ring 12',
    async ask(lab) {
      const rings = ringsOf((await lab.run({}, { keep: true })).placed);
      const level = Math.min(RING, rings.length - 1);
      return { level, count: rings[level], flat: 6 * level };
    },
    right: ({ count }) => count,
    words: ({ level, count, flat }) => [
      `Ring ${level} of this surface has ${plural(count, 'particle')}; on a plane it would have ${flat}.`,
      count === flat
        ? 'The bars below the picture follow 6k, as in a plane.'
        : count < flat
          ? 'The surface closes around the seed and takes room from the rings: the bars below the picture fall behind 6k.'
          : 'The surface bends like a saddle around the seed, which gives the rings more room: the bars below the picture run ahead of 6k.',
    ],
  }),
  'predict-seam': one({
    question: 'On which ring does the front first meet itself out of step, so that seams begin?',
    kind: 'choice',
    choices: choices({
      first: 'On the first, around the seed',
      six: 'On the first that does not have six more than the one before',
      longest: 'On the longest, after which the rings shrink',
      last: 'On the last, where the front closes',
    }),
    ask: firstSeamOf,
    right({ rings, first }) {
      const far = (/** @type {string} */ name) => Math.abs(OFFERED[name](rings) - first);
      return first === 0 ? 'none' : Object.keys(OFFERED).reduce((best, one) => (far(one) < far(best) ? one : best));
    },
    words({ rings, first }) {
      if (first === 0) return ['On this surface the front never meets itself out of step.'];
      const off = OFFERED.six(rings);
      const words = `The front first meets itself out of step on ring ${first} of ${rings.length - 1}, at the crosses of the picture.`;
      if (Math.abs(off - first) > 1) return [words];
      return [
        words,
        `Up to ring ${off - 1} each has six more than the one before, as in a plane: whichever way a row has come, it fits. Ring ${off} has ${rings[off]} particles instead of ${6 * off}, since the surface bends: neighbours no longer agree on the place of the child between them.`,
      ];
    },
  }),
  'predict-rest': one({
    question: 'Ten steps later, what has changed by more than chance?',
    kind: 'choice',
    choices: choices({
      hole: 'The largest hole',
      six: 'The share with six neighbours',
      both: 'Both',
      neither: 'Neither',
    }),
    ask: scoresOfRest,
    right(/** @type {Score[]} */ scores) {
      const changed = /** @type {const} */ (['hole', 'six']).filter((key) => verdictOf(scores, [key]));
      return changed.length === 2 ? 'both' : (changed[0] ?? 'neither');
    },
    words: ([before, after]) => [
      `The largest hole was ${written('hole', before)} and is ${written('hole', after)}; ${written('six', before)} had six neighbours and ${written('six', after)} have.`,
      'The pushes share out the room that there is: particles around a hole move in. For a particle to get another neighbour, whole rows would have to slip past each other, and hardly any does.',
    ],
  }),
  'predict-newton': one({
    question:
      'A child starts in the tangent plane, 2r from its parent, where this surface bends most. How far from the parent does Newton’s method land it?',
    kind: 'choice',
    choices: choices({ nearer: 'Nearer than 2r', same: 'At 2r', farther: 'Farther than 2r' }),
    async ask(lab) {
      const { profile, opened, whole, slot } = await openBend(lab);
      const { radius } = opened.subject;
      const landed = whole.children[slot].landed?.distance ?? 2 * radius;
      return { radius, landed, own: profile?.newtonDistance ?? null };
    },
    right({ own, radius }) {
      const share = own === null ? Number.NaN : own / (2 * radius);
      return share < NEARER ? 'nearer' : share > 1 / NEARER ? 'farther' : Number.isNaN(share) ? 'none' : 'same';
    },
    words: ({ own, landed, radius }) =>
      own === null
        ? ['Here Newton’s method lands nowhere near. The circle does.']
        : [
            `Newton’s method lands at ${inRadii(own, radius)}, the circle at ${inRadii(landed, radius)}.`,
            'It goes down the gradient and knows nothing of the parent: the open circle in the drawing is its landing.',
          ],
  }),
  'predict-sizes': one({
    question: 'Were all particles as small as the smallest ones here, how many would there be?',
    kind: 'choice',
    choices: choices({
      0: 'About the same number',
      1: 'Up to twice the number',
      2: 'Two to four times the number',
      3: 'More than that',
    }),
    async ask(lab) {
      const { end } = await adaptiveRun(lab, 'max_curvature');
      const [count, wanted] = [end.radii.length, asFineEverywhere(end.radii)];
      return { count, wanted, factor: wanted / count };
    },
    right: ({ factor }) => String(FACTORS.slice(1).filter((limit) => factor >= limit).length),
    words: ({ count, wanted, factor }) =>
      factor < FACTORS[0]
        ? [
            'On this surface the stronger curvature is nearly the same everywhere, and so are the radii. Nothing is saved here.',
          ]
        : [
            `Here ${plural(count, 'particle')} follow the curvature.`,
            `All as small as the smallest of them, they would be about ${formatCount(wanted)}, ${formatSignificant(factor, 2)} times as many: the sharpest bend, where the picture has its smallest discs, would rule the flat parts, too.`,
          ],
  }),
  'predict-pushes': one({
    question: 'How many pushes does a particle get in the ten steps of relaxation, on average?',
    kind: 'number',
    label: 'Pushes for each particle',
    ask: costOf,
    right: ({ rows }) => Math.round(rows[1].pushes),
    words: ({ rows }) => [
      `In each step that is ${formatFixed(rows[1].pushes / 10, 1)}: from its six neighbours at 2r, and now and then from one of the next, which are at 3.5r in a regular pattern but come nearer along seams.`,
      `Summing them is why the steps take longer than placing. They ask f ${formatSignificant(rows[1].evaluations, 3)} times for each particle, placing ${formatSignificant(rows[0].evaluations, 3)} times.`,
    ],
  }),
};

/** The parts of a question. @param {Question<any>} question */
export const partsOf = ({ rounds }) => rounds.flat();

/** The name under which the answer to a part is stored. @param {string} id @param {{ name: string }} part */
export const stopOf = (id, { name }) => (name ? `${id}-${name}` : id);

/**
 * The choices of a guess that a learner saved, by the name under which it is stored.
 * @param {string} stop
 */
export function choicesOf(stop) {
  if (Object.hasOwn(QUESTIONS, stop)) return partsOf(QUESTIONS[stop])[0].choices ?? [];
  if (/^judge-\d+-figure$/.test(stop)) return FIGURES;
  return /^judge-\d+-(eye|winner)$/.test(stop) ? SIDES : [];
}
