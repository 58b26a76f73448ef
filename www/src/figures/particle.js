/** Fetches from the lesson's worker what the drawings of a particle need: its events, and the plane of each slot. */
import { NO_PARENT } from '../engine/core-numbers.js';
import { along, cross, distance, dot, triple, unit, vec } from '../engine/vector.js';
import { inPlane, lensOf } from './geometry.js';
import { momentAt } from './moment.js';

/**
 * @import { LessonClient, LessonParticles, Vec3 } from '../engine/types.js'
 * @import { Child, Profile } from './types.js'
 */

/** Limit on |f|/|∇f| in radii, the same as in the lesson's runs. */
export const RESIDUAL = 1e-4;
/** Half size of a section in radii, and the number of its cells. */
const SECTION_HALF = 3.2;
const SECTION_CELLS = 64;
const LENS_CELLS = 24;

/**
 * Fetches the events of a particle and all data for its drawings, so that every step is shown at once.
 * @param {LessonClient} client @param {{ end: LessonParticles, radius: number }} run @param {number} particle
 */
export async function openParticle(client, { end, radius }, particle) {
  const life = await client.ask('life', { particle });
  const taken = life?.taken ?? null;
  const done = life?.done ?? null;
  const events =
    taken === null || done === null ? [] : await client.ask('events', { first: taken, count: done - taken + 1 });
  const place = triple(end.positions, particle);
  const frame = events.find(({ type }) => type === 'frame');
  const normal = frame?.type === 'frame' ? frame.normal : triple(end.normals, particle);
  const whole = events.length > 0 ? momentAt(events, events.length - 1) : null;
  const profiles = await Promise.all(
    (whole?.children ?? []).map((child) => (child.start ? profile(client, { place, normal, radius }, child) : null)),
  );
  const parent = end.parents[particle];
  const subject = {
    particle,
    level: end.levels[particle],
    levels: end.levels.reduce((a, b) => Math.max(a, b), 0),
    parent: parent === NO_PARENT ? null : parent,
    radius,
  };
  const { positions, normals, radii } = end;
  return { subject, place, normal, positions, normals, radii, events, profiles };
}

/**
 * @param {LessonClient} client @param {{ place: Vec3, normal: Vec3, radius: number }} about
 * @param {Child} child  at the end  @returns {Promise<Profile | null>}
 */
async function profile(client, { place, normal, radius }, { start, iterates, landed, pushes }) {
  if (!start) return null;
  const direction = pushes.length > 0 ? unit(start.place.map((v, k) => v - place[k])) : start.direction;
  const reach = pushes.length > 0 ? distance(start.place, place) : 2 * radius;
  const plane = { right: direction, up: normal };
  const [section, newton] = await Promise.all([
    client.ask('section', { ...plane, centre: place, half: SECTION_HALF * radius, cells: SECTION_CELLS }),
    client.ask('newton', { start: start.place, reach }),
  ]);
  const last = newton.at(-1);
  const lands = last !== undefined && Math.abs(last.value) <= RESIDUAL * radius * last.slope;
  const at = { centre: place, ...plane, radius };
  const tried = [...iterates, ...(landed ? [landed] : []), ...(lands ? newton : [])];
  const around = lensOf([start.place, ...tried.map(({ position }) => position)].map((q) => inPlane(at, q)));
  let lens = null;
  if (around) {
    const [x, y] = around.centre;
    const centre = vec((k) => place[k] + radius * (x * direction[k] + y * normal[k]));
    const cells = LENS_CELLS;
    lens = { ...around, section: await client.ask('section', { ...plane, centre, half: around.half * radius, cells }) };
  }
  return {
    normal,
    direction,
    reach,
    section,
    newton,
    newtonDistance: last && lands ? distance(last.position, place) : null,
    newtonAside: last && lands ? Math.abs(dot(along(last.position, place, -1), cross(direction, normal))) / radius : 0,
    lens,
  };
}
