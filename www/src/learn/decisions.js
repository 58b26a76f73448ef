/** What the algorithm decides at the slots of a particle, and what is wrong with another decision. */

import { distance, triple } from '../engine/vector.js';
import { inRadii, lineOf } from '../figures/words.js';
import { formatCount } from '../ui/format.js';

/**
 * @import { LessonEvent } from '../engine/types.js'
 * @import { Opened } from '../figures/types.js'
 * @import { Decision, Verdict } from './types.js'
 */

/** The fates that are decided by comparing. The others are found on the way to the surface. */
const DECIDED = ['parent', 'matched', 'added'];
/** Events that stand between a comparison and the fate that follows from it. */
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

/** The line of the algorithm that asks what is at a slot. @param {Decision} decision */
export const lineAt = ({ slot, compared }) =>
  slot > 0 && compared ? lineOf(compared) : lineOf({ type: 'fate', fate: 'parent', parent: 0, slot, particle: null });

/**
 * Returns why a verdict is not that of the run; empty if it is.
 * @param {Opened} opened @param {Decision} decision @param {Verdict} said
 */
export function objection({ subject, positions }, { slot, compared, verdict }, said) {
  const isSame = said.fate === verdict.fate && (said.fate !== 'matched' || said.particle === verdict.particle);
  if (isSame) return '';
  const name = (/** @type {number | null} */ particle) => `Particle ${formatCount(particle ?? 0)}`;
  if (verdict.fate === 'parent')
    return `${name(subject.parent)} is the parent, to which slot ${slot} points. It holds the slot, and nothing is placed or compared there.`;
  if (said.fate === 'parent')
    return subject.parent === null
      ? 'A seed has no parent: nobody placed it.'
      : 'The parent holds slot 0. This slot lies elsewhere.';
  if (!compared) return '';
  // Rounded first, since a distance of rounding errors would be written as a power of ten.
  const far = (/** @type {number} */ particle) => {
    const radii = distance(triple(positions, particle), compared.position) / subject.radius;
    return inRadii(Math.round(100 * radii) / 100, 1, 2);
  };
  const limit = inRadii(compared.limit, subject.radius, 2);
  const { particle } = verdict;
  if (verdict.fate === 'matched' && particle !== null) {
    const nearest = `${name(particle)} lies ${far(particle)} from this child`;
    return said.fate === 'added' || said.particle === null
      ? `${nearest}, within ${limit}. The two correspond, so nothing is added.`
      : `${nearest}, and ${far(said.particle)} lie between it and particle ${formatCount(said.particle)}. The nearest one counts.`;
  }
  if (said.particle === null) return `No particle lies within ${limit} of this child.`;
  return `${name(said.particle)} lies ${far(said.particle)} from this child, and only within ${limit} do two correspond. Nothing that was there before does, so the child is new.`;
}
