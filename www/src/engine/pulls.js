/**
 * Pulls: they draw a model's surface out or push it in around a point, while the rest stays.
 *
 * @module
 */
import { along, distance, size, vec } from './vector.js';

/** @import { FieldOk, Pull, Vec3 } from './types.js' */

/** Largest length of a pull divided by its reach; beyond it the surface would tear. */
export const LONGEST_PULL = 0.5;
/** Reach divided by length if the usual reach is too small, so that the surface does not become a spike. */
const REACH_OVER_WAY = 2.2;
/** Digits of a pull's numbers, as in single precision. */
const DIGITS = 6;

/** @param {number} v */
const short = (v) => Number(v.toPrecision(DIGITS));

/**
 * The pull that moves a point to another one, or as near as possible while the `held` points stay where they are.
 * @param {Vec3} at @param {Vec3} to
 * @param {{ reach: number, held: readonly Vec3[] }} how  `reach`: the usual one
 * @returns {Pull}
 */
export function pullBetween(at, to, { reach, held }) {
  const room = Math.min(...held.map((place) => distance(place, at)));
  const way = distance(to, at);
  // Held points lie beyond the reach, which is at least twice the length.
  const longest = (room * LONGEST_PULL) / (1 + LONGEST_PULL + 1e-3);
  const share = way > longest ? longest / way : 1;
  const by = vec((k) => short((to[k] - at[k]) * share));
  const gone = size(by);
  const widest = Math.max(reach, REACH_OVER_WAY * gone);
  return { at: vec((k) => short(at[k])), by, reach: short(Math.min(widest, room - gone)) };
}

/**
 * Whether a field is a model alone, without a formula that cuts or joins it.
 * @param {FieldOk | null} field
 */
export const isBareModel = (field) => Boolean(field?.model) && field?.formula === '';

/**
 * Whether a surface can be grabbed: a formula's surface by its parameters, a model alone by pulls. A formula of a model
 * has points that are not the model's. The surface of an image or a mesh cannot be grabbed.
 * @param {FieldOk | null} field
 */
export const canGrab = (field) =>
  field?.model ? isBareModel(field) : !field?.image && !field?.mesh && Boolean(field?.parameters.length);

/** The point to which a pull moves its own point. @param {Pull} pull @returns {Vec3} */
export const endOf = ({ at, by }) => along(at, by, 1);
