/** Measurements of a run for the figures, computed from its particles. */
import { NO_PARENT } from '../engine/core-numbers.js';
import { momentAt } from '../figures/moment.js';
import { openParticle } from '../figures/particle.js';
import { between, createGrid } from '../ui/neighbours.js';
import { NoSurface } from './lab.js';
import { scoreOf } from './score.js';

/**
 * @import { LessonParticles } from '../engine/types.js'
 * @import { Cost, Lab, LabRun } from './types.js'
 */

/**
 * Distance of each particle to its nearest one, divided by the sum of their radii: 1 if two discs touch. Infinite if
 * there is none within 2.5 times the largest radius.
 * @param {LessonParticles} particles
 */
export function nearestDistances({ positions, radii }) {
  const grid = createGrid(positions, radii.keys(), 2.5 * Math.max(...radii));
  return Float32Array.from(radii, (radius, i) => {
    let least = Infinity;
    for (const ring of [0, 1])
      for (const j of grid.around(i, ring))
        if (j !== i) least = Math.min(least, between(positions, i, j) / (radius + radii[j]));
    return least;
  });
}

/**
 * Distance of each particle to its parent divided by 2r, as placed; 1 for a seed.
 * @param {LessonParticles} placed
 * @param {number} radius
 */
export const parentDistances = ({ positions, parents }, radius) =>
  Float32Array.from(parents, (parent, i) => (parent === NO_PARENT ? 1 : between(positions, i, parent) / (2 * radius)));

/**
 * Whether a run's surface is closed, judging by its particles: none is so near the box that the surface could end
 * there.
 * @param {LabRun} run
 */
export function isClosed({ lab: { surface }, placed: { positions, radii } }) {
  const { min, max } = surface.bounds;
  return radii.every((radius, i) =>
    [0, 1, 2].every((k) => Math.min(positions[3 * i + k] - min[k], max[k] - positions[3 * i + k]) > 2 * radius),
  );
}

/** The ring in the question. */
export const RING = 12;

/** Number of particles on each level of the first front. @param {LessonParticles} particles */
export function ringsOf({ levels, fronts }) {
  /** @type {number[]} */
  const rings = [];
  for (let i = 0; i < levels.length; i += 1) if (fronts[i] === 0) rings[levels[i]] = (rings[levels[i]] ?? 0) + 1;
  return Array.from(rings, (count) => count ?? 0);
}

/**
 * The scores of a run before its first relaxation step and after its last.
 * @param {Lab} lab
 */
export async function scoresOfRest(lab) {
  const run = await lab.run({}, { keep: true });
  const how = { evaluations: run.progress.evaluations, isAdaptive: false };
  return [await scoreOf(lab, run.placed, { ...how, evaluations: run.placing }), await scoreOf(lab, run.end, how)];
}

/**
 * The child and parent between which the surface bends most; null without a child.
 * @param {LessonParticles} placed
 */
export function sharpestBend({ normals, parents }) {
  let [child, least] = [-1, 2];
  for (let i = 0; i < parents.length; i += 1) {
    const parent = parents[i];
    if (parent === NO_PARENT) continue;
    const cosine = [0, 1, 2].reduce((sum, k) => sum + normals[3 * i + k] * normals[3 * parent + k], 0);
    if (cosine < least) [child, least] = [i, cosine];
  }
  return child < 0 ? null : { child, parent: parents[child] };
}

/**
 * Opens a particle at one of its slots.
 * @param {LabRun} run @param {number} particle @param {number} slot
 */
async function openSlot(run, particle, slot) {
  const opened = await openParticle(run.client, run, particle);
  const whole = momentAt(opened.events, opened.events.length - 1);
  return { run, opened, whole, slot, profile: opened.profiles[slot] };
}

/**
 * Opens the particle around which the surface bends most, at the slot of the child beyond the bend.
 * @param {Lab} lab
 */
export async function openBend(lab) {
  const run = await lab.coarse();
  const bend = sharpestBend(run.placed);
  if (!bend) throw new NoSurface('The surface holds one particle only, which has no children.');
  const at = await openSlot(run, bend.parent, 1);
  const beyond = at.whole.children.find(({ particle, fate }) => particle === bend.child && fate === 'added');
  return beyond ? { ...at, slot: beyond.slot, profile: at.opened.profiles[beyond.slot] } : at;
}

/**
 * Number of particles of one size, the smallest of these radii, that would cover the same area.
 * @param {ArrayLike<number>} radii
 */
export function asFineEverywhere(radii) {
  const all = Array.from(radii);
  const least = Math.min(...all);
  return all.reduce((sum, radius) => sum + (radius / least) ** 2, 0);
}

/**
 * For each ring, the particles that the front met out of step when it placed the ring; for the last, also those met
 * when nothing was left to place.
 * @param {LabRun} run
 */
export async function meetingsOf({ client, chapters }) {
  /** @type {number[][]} */
  const found = [[]];
  // The particles of a level place the next ring.
  for (const { first_event: first, events: count } of chapters.filter(({ kind }) => kind === 'level')) {
    const events = await client.ask('events', { first, count });
    found.push(events.flatMap((event) => (event.type === 'fronts_meet' ? [event.particle] : [])));
  }
  return [...found.slice(0, -2), found.slice(-2).flat()];
}

/**
 * The sizes of the rings, and the ring on which the front first meets itself out of step; 0 if it never does.
 * @param {Lab} lab
 */
export async function firstSeamOf(lab) {
  const run = await lab.run({}, { keep: true });
  const first = (await meetingsOf(run)).findIndex(({ length }) => length > 0);
  return { rings: ringsOf(run.placed), first: Math.max(0, first) };
}

/**
 * The counts on this page: placing, ten relaxation steps, and the whole run of the other method.
 * @param {Lab} lab
 * @returns {Promise<Cost>}
 */
export async function costOf(lab) {
  const { progress, placing } = await lab.run({}, { keep: true });
  const other = await lab.run({ method: 'witkin_heckbert', radius_max: 0 });
  const { particles, evaluations, interactions, steps } = progress;
  const share = (/** @type {number} */ count, /** @type {number} */ of) => count / Math.max(1, of);
  return {
    particles,
    others: other.progress.particles,
    rows: [
      { name: 'Placing, once', evaluations: share(placing, particles), pushes: 0, rounds: 0 },
      {
        name: 'Relaxation after it',
        evaluations: share(evaluations - placing, particles),
        pushes: share(interactions, particles),
        rounds: steps,
      },
      {
        name: 'Witkin and Heckbert’s system',
        evaluations: share(other.progress.evaluations, other.progress.particles),
        pushes: share(other.progress.interactions, other.progress.particles),
        rounds: other.progress.steps,
      },
    ],
  };
}
