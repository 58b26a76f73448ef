/**
 * The patches on which a learner plays the algorithm: the decisions at the slots of a particle, and objections to other
 * decisions.
 */

import { distance, triple } from '../engine/vector.js';
import { momentAt } from '../figures/moment.js';
import { openParticle } from '../figures/particle.js';
import { inRadii } from '../figures/words.js';

/**
 * @import { LessonEvent } from '../engine/types.js'
 * @import { Opened } from '../figures/types.js'
 * @import { Decision, Lab, LabRun, Patch, Verdict } from './types.js'
 */

/** @type {readonly Patch[]} */
export const PATCHES = [
  {
    id: 'plane',
    name: 'A plane',
    surface: { formula: 'z = 0', parameters: [], bounds: { min: [-1, -1, -0.5], max: [1, 1, 0.5] } },
    radius: 0.13,
    seed: [0, 0, 0],
    asks: 'predict-children',
    waits: 'Particle A is done. Before B has its turn, answer the question below.',
    ends: 'Two particles are done. In a plane every child met its particle exactly, or none at all.',
  },
  {
    id: 'cap',
    name: 'A cap, at its seam',
    surface: {
      formula: 'x^2 + y^2 + z^2 = 1',
      parameters: [],
      bounds: { min: [-1.1, -1.1, -0.6], max: [1.1, 1.1, 1.1] },
    },
    radius: 0.3,
    seed: [0, 0, 1],
    isAtSeam: true,
    ends: 'The front has met itself, out of step. On a cap a ring has no room for six more than the one before.',
  },
];

/** @param {Lab} lab @param {Patch} patch */
export const runOn = (lab, { surface, radius, seed }) =>
  lab.beside(surface).run({ relax_steps: 0, radius, seeds: [seed] }, { keep: true });

/** The fates of the children of the seed's first child. @param {Lab} lab */
export async function childrenOf(lab) {
  const run = await runOn(lab, PATCHES[0]);
  try {
    const { events } = await openParticle(run.client, run, 1);
    const fates = momentAt(events, events.length - 1).children.map(({ fate }) => fate);
    const count = (/** @type {string} */ name) => fates.filter((fate) => fate === name).length;
    return { added: count('added'), matched: count('matched') };
  } finally {
    run.client.close();
  }
}

/** A particle's name: a letter, unlike a slot's number. @param {number} particle @returns {string} */
export const letterOf = (particle) =>
  (particle < 26 ? '' : letterOf(Math.floor(particle / 26) - 1)) + String.fromCharCode(65 + (particle % 26));

/**
 * A particle of a patch with its events; particles are named by letters.
 * @param {LabRun} run @param {number} particle @returns {Promise<Opened>}
 */
export async function openNamed(run, particle) {
  const opened = await openParticle(run.client, run, particle);
  return { ...opened, subject: { ...opened.subject, nameOf: letterOf } };
}

/** Number of particles of a plane that the learner treats: the seed and its first child. */
const TREATED = 2;
/** Number of particles that are searched for the first meeting of a front. */
const MOST_BEFORE = 60;

/** The particles that the learner treats: the first ones, or the one where the front meets itself. */
export async function treatedOf(/** @type {LabRun} */ run, /** @type {Patch} */ { isAtSeam }) {
  const all = [...Array(Math.min(isAtSeam ? MOST_BEFORE : TREATED, run.placed.radii.length)).keys()];
  if (!isAtSeam) return all;
  for (const particle of all) {
    const { events } = await openParticle(run.client, run, particle);
    if (decisionsOf(events).some(({ met }) => met)) return [particle];
  }
  return [0];
}

/**
 * The fates that a comparison decides. Slot 0 always holds the parent; other fates follow from the search for the
 * surface.
 */
const DECIDED = ['matched', 'added'];
/** Events between a comparison and its fate. */
const BETWEEN = ['added', 'fronts_meet'];

/** Returns the decisions of a particle, in the order of the run. @param {readonly LessonEvent[]} events */
export function decisionsOf(events) {
  return events.flatMap((event, end) => {
    if (event.type !== 'fate' || !DECIDED.includes(event.fate)) return [];
    let at = end - 1;
    while (BETWEEN.includes(events[at].type)) at -= 1;
    const { slot, particle } = event;
    const before = events[at];
    const compared = before.type === 'compared' ? before : null;
    const met = events.slice(at, end).find(({ type }) => type === 'fronts_meet') ?? null;
    const fate = /** @type {Verdict['fate']} */ (event.fate);
    return [/** @type {Decision} */ ({ slot, at, end, compared, met, verdict: { fate, particle } })];
  });
}

/**
 * Returns why a verdict differs from the run's; empty if it does not.
 * @param {Opened} opened @param {Decision} decision @param {Verdict} said
 */
export function objection({ subject, positions }, { compared, verdict }, said) {
  const isSame = said.fate === verdict.fate && (said.fate !== 'matched' || said.particle === verdict.particle);
  if (isSame) return '';
  if (!compared) return '';
  const name = (/** @type {number | null} */ particle) => `Particle ${letterOf(particle ?? 0)}`;
  // Rounded first, so that a rounding error is not written as a power of ten.
  const far = (/** @type {number} */ particle) => {
    const radii = distance(triple(positions, particle), compared.position) / subject.radius;
    return inRadii(Math.round(100 * radii) / 100, 1, 2);
  };
  const limit = `the tolerance of ${inRadii(compared.limit, subject.radius, 2)}`;
  const { particle } = verdict;
  if (verdict.fate === 'matched' && particle !== null) {
    const nearest = `${name(particle)} lies ${far(particle)} from this child`;
    return said.fate === 'added' || said.particle === null
      ? `${nearest}, within ${limit}. It is the child, so nothing is added.`
      : `${nearest}, particle ${letterOf(said.particle)} ${far(said.particle)} from it. The nearest one counts.`;
  }
  if (said.particle === null) return `No particle lies within ${limit} of this child.`;
  return `${name(said.particle)} lies ${far(said.particle)} from this child, beyond ${limit}. Nothing that was there before is nearer, so the child is new.`;
}
