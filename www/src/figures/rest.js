/** A relaxation step of one particle (paper §4.5): the pushes and their sum, the move, and the landing. */
import { size, triple } from '../engine/vector.js';
import { formatCount, formatFixed, formatSignificant, plural } from '../ui/format.js';
import { inRadii } from './words.js';

/**
 * @import { LessonChapter, LessonClient } from '../engine/types.js'
 * @import { Rest } from './types.js'
 */

/**
 * Fetches a relaxation step of a particle; null if the run has no such step.
 * @param {LessonClient} client
 * @param {readonly LessonChapter[]} chapters
 * @param {number} particle
 * @param {number} step  from 1
 * @returns {Promise<Rest | null>}
 */
export async function restOf(client, chapters, particle, step) {
  const steps = chapters.filter(({ kind }) => kind === 'relaxation');
  const chapter = steps[step - 1];
  if (!chapter) return null;
  const first = chapter.first_event;
  const [begins] = await client.ask('events', { first, count: 1 });
  const [moved] = await client.ask('events', { first: first + 1 + particle, count: 1 });
  if (begins?.type !== 'step_begins' || moved?.type !== 'moved') return null;
  // At this event the step has begun and nothing has moved. Both are asked at once, so that no question comes between.
  const [{ positions, normals, radii }, pushes] = await Promise.all([
    client.ask('seek', { event: first + 1 }),
    client.ask('pushes', { particle }),
  ]);
  return {
    step,
    steps: steps.length,
    size: begins.size,
    before: begins.energy,
    after: chapter.energy ?? Number.NaN,
    largest: chapter.largest_move ?? Number.NaN,
    place: triple(positions, particle),
    normal: triple(normals, particle),
    radius: radii[particle],
    pushes: pushes
      .filter(({ force }) => size(force) > 0)
      .map((push) => ({ ...push, at: triple(positions, push.particle), radius: radii[push.particle] }))
      .sort((a, b) => size(b.force) - size(a.force)),
    moved,
  };
}

/**
 * Returns the particle that is pushed most in a step; −1 if the run has no such step.
 * @param {LessonClient} client @param {readonly LessonChapter[]} chapters @param {number} step  from 1
 */
export async function mostPushed(client, chapters, step) {
  const chapter = chapters.filter(({ kind }) => kind === 'relaxation')[step - 1];
  if (!chapter) return -1;
  let [found, most] = [-1, -1];
  for (const event of await client.ask('events', { first: chapter.first_event, count: chapter.events })) {
    if (event.type !== 'moved' || size(event.force) <= most) continue;
    [found, most] = [event.particle, size(event.force)];
  }
  return found;
}

/** Returns the number of the pushes and their sum, in words. @param {Rest} rest */
export function pushWords({ pushes, moved, radius }) {
  const sum = inRadii(size(moved.force), radius);
  return pushes.length === 0
    ? 'nobody pushes it'
    : `${plural(pushes.length, 'particle pushes', 'particles push')} it, together by ${sum}`;
}

/**
 * The move of a step, the way that it lands off the tangent plane, and whether the move was cut short.
 * @param {Rest} rest
 */
function moveOf({ place, moved, size: share }) {
  const way = [0, 1, 2].map((k) => moved.target[k] - place[k]);
  const lands = [0, 1, 2].map((k) => moved.position[k] - place[k]);
  return { move: size(way), lands: size(lands), isShort: size(way) < 0.999 * share * size(moved.force) };
}

/** Tells a step of a particle in two or three sentences. @param {Rest} rest */
export function tellRest(rest) {
  const { step, steps, moved, size: share, radius } = rest;
  const { move, lands, isShort } = moveOf(rest);
  const head = `Step ${formatCount(step)} of ${formatCount(steps)}: ${pushWords(rest)}.`;
  const cut = isShort ? ', cut off there' : '';
  const wanted = `A step of ${formatSignificant(share, 2)} makes that a move of ${inRadii(move, radius)}${cut}.`;
  return moved.is_kept
    ? `${head} ${wanted} It stays where it is, since the move leads out of the box, off the surface or around a fold.`
    : `${head} ${wanted} Back on the surface it is ${inRadii(lands, radius)} from where it was.`;
}

/** The numbers of a step. @param {Rest} rest @returns {[string, string][]} */
export function numbersOfRest(rest) {
  const { moved, radius, before, after, largest, pushes, size: share } = rest;
  const { move, lands } = moveOf(rest);
  const own = pushes.reduce((sum, push) => sum + 0.5 * push.energy, 0);
  return [
    ['Sum of the pushes', inRadii(size(moved.force), radius, 4)],
    ['Size of the step', formatSignificant(share, 2)],
    ['Move in the tangent plane', inRadii(move, radius, 4)],
    ['From its place to its landing', moved.is_kept ? 'it stays' : inRadii(lands, radius, 4)],
    ['Its own energy before', formatSignificant(own, 3)],
    ['Energy per particle, before and after', `${formatSignificant(before, 4)}, ${formatSignificant(after, 4)}`],
    ['Longest move of all', `${formatFixed(largest, 3)}\u00a0r`],
  ];
}

/** Returns the pushes in words, for readers who do not see the drawing. @param {Rest} rest */
export const pushersOf = ({ pushes, radius }) =>
  pushes.map(
    ({ particle, distance, force }) =>
      `Particle ${formatCount(particle)}, ${inRadii(distance, radius, 2)} away, pushes by ${inRadii(size(force), radius)}`,
  );
