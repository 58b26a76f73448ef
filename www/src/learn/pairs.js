/**
 * Pairs of samplings for the learner to judge: the one at the beginning, and random ones, each with a purpose told by a
 * story. A figure that differs by no more than chance is a tie. Pairs whose difference is near chance are not used.
 */
import { adaptiveRun } from './adaptive.js';
import { bestOf, chanceOf, ROWS, rowOf, scoreOf, written } from './score.js';

/**
 * @import { SurfaceInfo } from '../engine/types.js'
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { Judged, JudgedSide, Lab, LabRun, Question, Score, ScoreFigures } from './types.js'
 */

/** A torus on which the eye prefers the sampling with less order. @type {FormulaSurface} */
export const TORUS = {
  formula: '(sqrt(x^2 + y^2) - 0.7)^2 + z^2 = 0.09',
  parameters: [],
  bounds: { min: [-1.2, -1.2, -0.5], max: [1.2, 1.2, 0.5] },
};

/** Answers to the question of which sampling is better. */
export const SIDES = [
  { value: 'a', label: 'Sampling A' },
  { value: 'b', label: 'Sampling B' },
  { value: 'alike', label: 'Neither: they differ by chance at most' },
];

/** The same answers before chance has been introduced. */
export const PLAIN_SIDES = SIDES.with(2, { value: 'alike', label: 'Neither: they are alike' });

/**
 * The purpose of a sampling, and the figure that measures how well it serves that.
 * @type {readonly { key: keyof ScoreFigures, story: string, why: string }[]}
 */
export const PURPOSES = [
  {
    key: 'hole',
    story: 'A scanner looks into a body at the particles. Thin tumours must not fall between them.',
    why: 'A tumour can hide where the surface is barest, in the largest hole.',
  },
  {
    key: 'six',
    story:
      'A machine knits a cover of hexagons, one around each particle. Where six do not meet it stops, and somebody knits on by hand.',
    why: 'The machine goes on where a particle has six neighbours.',
  },
  {
    key: 'pair',
    story:
      'A sensor is glued to each particle. Two that stand close disturb each other, and spoil the whole measurement.',
    why: 'The first two to disturb each other are the closest pair.',
  },
  {
    key: 'gap',
    story:
      'A mould is milled from a mesh of the particles. It is as good as its worst place, farthest from the surface.',
    why: 'The mould is worst where the gap between surface and mesh is widest.',
  },
];

/** Answers to the question of which figure decides. */
export const FIGURES = ROWS.filter(({ key }) => PURPOSES.some((purpose) => purpose.key === key)).map(
  ({ key, name }) => ({ value: key, label: name }),
);

/** @param {string} name @param {JudgedSide['settings']} settings */
const side = (name, settings) => ({ name, settings });
/** A pair compares one of these with the other. @type {readonly (readonly [JudgedSide, JudgedSide])[]} */
const RIVALS = [
  [side('a queue, relaxed', {}), side('a stack, relaxed', { order: 'stack' })],
  [side('a stack, relaxed', { order: 'stack' }), side('a queue, not relaxed', { relax_steps: 0 })],
  [side('a queue, relaxed', {}), side('a queue, not relaxed', { relax_steps: 0 })],
  [side('one seed', { seed: 1 }), side('another seed', { seed: 2 })],
];
/** @type {readonly [JudgedSide, JudgedSide]} */
export const SIZES = [side('one size', {}), { name: 'sizes that follow the bends', settings: {}, isAdaptive: true }];

/** The pair at the beginning, where neither a queue nor a stack is known yet. @type {Judged} */
export const OPENING = {
  surface: TORUS,
  name: 'Torus',
  sides: [side('relaxed', { order: 'stack' }), side('not relaxed', { relax_steps: 0 })],
  particles: 1500,
};

/** Runs of sampling B with different seeds, which show what chance is. */
export const SEEDS = 5;

/** Sampling B with a seed. @param {Lab} lab @param {number} seed */
export function fromSeed(lab, seed) {
  const { surface, sides, particles } = OPENING;
  return lab.on(surface).run({ ...sides[1].settings, ...(seed > 0 ? { seed } : {}) }, { particles });
}

/** Particles in a random pair: enough for the figures, few enough to wait for. */
const DRAWN = 600;
/** Number of pairs tried until one is clear. */
const MOST_TRIALS = 6;
/** A difference within these multiples of chance is neither clear nor clearly a tie. */
const UNCLEAR = [0.75, 1.25];

/**
 * The run of a side.
 * @param {Lab} lab
 * @param {Judged} pair
 * @param {JudgedSide} of
 * @returns {Promise<LabRun>}
 */
function runOf(lab, { surface, particles }, { settings, isAdaptive = false }) {
  const own = lab.on(surface);
  return isAdaptive ? adaptiveRun(own, 'chord_error', settings, particles) : own.run(settings, { particles });
}

/**
 * The runs of both sides; with `isAlike` the second has as many particles as the first.
 * @param {Lab} lab @param {Judged} pair
 */
export async function runsOf(lab, pair) {
  const [first, second] = pair.sides;
  const one = await runOf(lab, pair, first);
  if (!pair.isAlike) return [one, await runOf(lab, pair, second)];
  return [one, await one.lab.runAsMany(second.settings, one)];
}

/** The score of a run, relative to the ideal of one size whatever its sizes are. @param {LabRun} run */
export const scoreAlike = ({ lab, end, progress: { evaluations } }) =>
  scoreOf(lab, end, { evaluations, isAdaptive: false });

/** Both scores. @param {Lab} lab @param {Judged} pair */
export const scoresOf = async (lab, pair) => Promise.all((await runsOf(lab, pair)).map(scoreAlike));

/**
 * The right value of {@link SIDES} according to a figure.
 * @param {readonly Score[]} scores @param {keyof ScoreFigures} key
 */
export const winnerOf = (scores, key) => ['alike', 'a', 'b'][bestOf(scores, rowOf(key)) + 1];

/**
 * If fewer particles than this share have six neighbours in both, the surface bends too much within 2r for the figures
 * to mean anything.
 */
const LEAST_ORDER = 0.6;

/**
 * Whether a figure clearly differs, or clearly does not.
 * @param {readonly Score[]} scores @param {keyof ScoreFigures} key
 */
export function isClear(scores, key) {
  const [one, other] = scores.map((score) => score[key]);
  if (one === null || other === null || scores.every(({ six }) => Number(six) < LEAST_ORDER)) return false;
  const share = Math.abs(one - other) / Number(chanceOf(rowOf(key), scores));
  return share < UNCLEAR[0] || share > UNCLEAR[1];
}

/** Random numbers from 0 to 1 determined by a text (FNV-1a, then mulberry32). @param {string} text */
function randomOf(text) {
  let state = 0x811c9dc5;
  for (const letter of text) state = Math.imul(state ^ (letter.codePointAt(0) ?? 0), 0x01000193);
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let bits = Math.imul(state ^ (state >>> 15), 1 | state);
    bits = (bits + Math.imul(bits ^ (bits >>> 7), 61 | bits)) ^ bits;
    return ((bits ^ (bits >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** A surface of higher genus bends too much within 2r, and its run takes long. */
const MOST_GENUS = 3;

/** Surfaces that the lesson shows before, by their identifiers in the gallery. */
const SHOWN = ['ellipsoid', 'torus'];

/**
 * The gallery surfaces for random pairs: closed, in one piece, without self-intersections, and not shown before.
 * @param {readonly SurfaceInfo[]} gallery
 */
export const drawable = (gallery) =>
  gallery.filter(({ id, genus, formula }) => formula && genus !== null && genus <= MOST_GENUS && !SHOWN.includes(id));

/** The share of pairs that are meant to be ties. */
const TIES = 0.3;

/**
 * The pair with a number in a series, which a text determines. Every third pair compares one size with many, and also
 * asks for the widest gap to a mesh. Purposes alternate as far as they are clear.
 * @param {Lab} lab @param {readonly SurfaceInfo[]} surfaces @param {string} series @param {number} number  from 0
 */
export async function drawn(lab, surfaces, series, number) {
  const random = randomOf(`${series} ${number}`);
  /** @template T @param {readonly T[]} all */
  const pick = (all) => all[Math.floor(random() * all.length)];
  const isOfSizes = number % 3 === 1;
  const isTie = random() < TIES;
  const allowed = PURPOSES.filter(({ key }) => key !== 'gap' || isOfSizes);
  const first = Math.floor(randomOf(series)() * allowed.length) + number;
  const purposes = allowed.map((_, k) => allowed[(first + k) % allowed.length]);
  for (let trial = 1; ; trial += 1) {
    const { name, formula, parameters, bounds } = pick(surfaces);
    const rivals = isOfSizes ? SIZES : pick(RIVALS);
    const sides = random() < 0.5 ? rivals : /** @type {const} */ ([rivals[1], rivals[0]]);
    /** @type {Judged} */
    const pair = { surface: { formula, parameters, bounds }, name, sides, particles: DRAWN, isAlike: !isOfSizes };
    const isLast = trial === MOST_TRIALS;
    try {
      const scores = await scoresOf(lab, pair);
      const clear = purposes.filter(({ key }) => isClear(scores, key));
      const purpose = clear.find(({ key }) => (winnerOf(scores, key) === 'alike') === isTie);
      if (purpose || isLast) return { pair, purpose: purpose ?? clear[0] ?? purposes[0] };
    } catch (error) {
      if (isLast) throw error;
    }
  }
}

/**
 * The question about a random pair: first by eye, then by its figures.
 * @param {Awaited<ReturnType<typeof drawn>>} of @returns {Question<readonly Score[]>}
 */
export function questionOf({ pair, purpose: { key, story, why } }) {
  const right = (/** @type {readonly Score[]} */ scores) => winnerOf(scores, key);
  const { name, writeChance, write } = rowOf(key);
  return {
    question: `${story} Which sampling is better for that?`,
    rounds: [
      [{ name: 'eye', kind: 'choice', legend: 'By eye:', choices: SIDES, right }],
      [
        { name: 'figure', kind: 'choice', legend: 'Which figure tells?', choices: FIGURES, right: () => key },
        { name: 'winner', kind: 'choice', legend: 'Which is better by it?', choices: SIDES, right },
      ],
    ],
    ask: (lab) => scoresOf(lab, pair),
    words: (scores) => [
      `This is the surface ${pair.name}. ${why} ${name}: ${written(key, scores[0])} in A, ${written(key, scores[1])} in B.`,
      `Up to ${(writeChance ?? write)(Number(chanceOf(rowOf(key), scores)))} of a difference may be chance.`,
    ],
  };
}
