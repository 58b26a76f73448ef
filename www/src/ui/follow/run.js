/**
 * A run of the paper's algorithm on the surface of the picture: what it is asked for, and how it relates to the
 * picture.
 */

import { NO_PARENT } from '../../engine/core-numbers.js';
import { distance, triple } from '../../engine/vector.js';
import { RESIDUAL } from '../../figures/particle.js';

/**
 * @import { Engine, LessonParticles, LessonSettings, Vec3 } from '../../engine/types.js'
 * @import { FollowedRun } from './types.js'
 */

/**
 * Settings of a run: Algorithm 2 child by child. Matched particles stay among the neighbours, as in the picture's own
 * front.
 */
const SETTINGS = /** @type {const} */ ({
  placing: 'one_by_one',
  matched: 'stay',
  gaps: 'leave',
  relax_steps: 0,
  residual: RESIDUAL,
});

/** Settings of the picture that decide the sizes of adaptive particles. */
const SIZES = ['radius_law', 'chord_error', 'curvature_scale', 'radius_min_share', 'radius_max_share'];

/** A setting of the picture. @param {Engine} engine @param {string} name */
export const settingOf = ({ state, description }, name) =>
  state.value.settings[name] ?? description.value?.settings.find((setting) => setting.name === name)?.default;

/** Returns whether the picture is of a solid that is made of the surface. @param {Engine} engine */
export const isOfSolid = (engine) =>
  engine.field.peek()?.model === null &&
  (settingOf(engine, 'box_faces') === 'closed' || Number(settingOf(engine, 'thickness')) > 0);

/**
 * Returns what a run is asked for, with the sizes of the picture. Adaptive particles have the law of the picture, as it
 * is: the paper has nothing that grades it.
 * @param {Engine} engine @param {Pick<FollowedRun, 'radius' | 'adaptive'>} run
 * @returns {Partial<LessonSettings>}
 */
export function settingsOf(engine, { radius, adaptive }) {
  const seeds = seedsOf(engine);
  if (!adaptive) return { ...SETTINGS, seeds, radius };
  const bounds = engine.field.peek()?.bounds;
  const diagonal = bounds ? Math.hypot(...bounds.max.map((v, k) => v - bounds.min[k])) : 1;
  const number = (/** @type {string} */ name) => Number(settingOf(engine, name));
  const law = /** @type {'chord_error' | 'max_curvature' | 'sum_of_curvatures'} */ (settingOf(engine, 'radius_law'));
  // A gap between surface and triangle grows with the square of the radius.
  const scale =
    law === 'chord_error' ? number('chord_error') * diagonal * radius ** 2 : number('curvature_scale') * radius;
  return {
    ...SETTINGS,
    seeds,
    sampling: 'adaptive',
    law,
    law_scale: scale,
    radius_min: number('radius_min_share') * diagonal * radius,
    radius_max: number('radius_max_share') * diagonal * radius,
  };
}

/** Names the surface of the picture, and the sizes on it, so that a change can be told. @param {Engine} engine */
export function surfaceKey(engine) {
  const { formula, parameters, bounds, surface, model } = engine.field.value ?? {};
  const values = parameters?.map(({ name, value }) => [name, value]);
  const isAdaptive = settingOf(engine, 'sampling') === 'adaptive';
  const sizes = isAdaptive ? SIZES.map((name) => settingOf(engine, name)) : null;
  const solid = ['box_faces', 'box_cell', 'thickness'].map((name) => settingOf(engine, name));
  return JSON.stringify([formula, values, bounds, surface, model, engine.state.value.pulls, sizes, solid]);
}

/** The points at which the fronts of the picture began. @param {Engine} engine @returns {Vec3[]} */
function seedsOf({ columns }) {
  const seeds = [];
  for (let i = 0; i < columns.count; i += 1)
    if (columns.parents[i] === NO_PARENT) seeds.push(triple(columns.placed, i));
  return seeds;
}

/**
 * Counts the first particles of a run that are those of the picture: at the same place, up to rounding.
 * @param {{ placed: ArrayLike<number>, count: number }} picture @param {LessonParticles} end @param {number} radius
 */
export function alikeIn({ placed, count }, { positions }, radius) {
  const most = Math.min(count, positions.length / 3);
  let i = 0;
  while (i < most && distance(triple(positions, i), triple(placed, i)) < radius) i += 1;
  return i;
}
