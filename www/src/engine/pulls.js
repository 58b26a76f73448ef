/**
 * Pulls, by which the surface of a model is drawn out or pushed in around a place while the rest of it stays.
 *
 * @module
 */
import { along, distance, size, vec } from './vector.js';

/** @import { FieldOk, Pull, Vec3 } from './types.js' */

/** Largest way of a pull over its reach: beyond it the surface would tear. */
export const LONGEST_PULL = 0.5;
/** Reach of a pull over its way where the usual one is too small, so that the surface is not drawn to a point. */
const REACH_OVER_WAY = 2.2;
/** Digits of the numbers of a pull, as many as single precision holds. */
const DIGITS = 6;

/** @param {number} v */
const short = (v) => Number(v.toPrecision(DIGITS));

/**
 * The pull that takes a place to another one, or as near to it as the `held` places allow, which stay where they are.
 * @param {Vec3} at @param {Vec3} to
 * @param {{ reach: number, held: readonly Vec3[] }} how  `reach`: the usual one
 * @returns {Pull}
 */
export function pullBetween(at, to, { reach, held }) {
  const room = Math.min(...held.map((place) => distance(place, at)));
  const way = distance(to, at);
  // What is held lies beyond the reach, which is at least twice the way.
  const longest = (room * LONGEST_PULL) / (1 + LONGEST_PULL + 1e-3);
  const share = way > longest ? longest / way : 1;
  const by = vec((k) => short((to[k] - at[k]) * share));
  const gone = size(by);
  const widest = Math.max(reach, REACH_OVER_WAY * gone);
  return { at: vec((k) => short(at[k])), by, reach: short(Math.min(widest, room - gone)) };
}

/**
 * Whether a field is a model by itself, without a formula that cuts or joins it.
 * @param {FieldOk | null} field
 */
export const isBareModel = (field) => Boolean(field?.model) && field?.formula === '';

/**
 * Whether a surface can be grabbed: the surface of a formula by its parameters, a model by pulls.
 * What a formula makes of a model has places that are not the model's. The surface of an image or a mesh cannot be.
 * @param {FieldOk | null} field
 */
export const canGrab = (field) =>
  field?.model ? isBareModel(field) : !field?.image && !field?.mesh && Boolean(field?.parameters.length);

/** Where the place of a pull comes to. @param {Pull} pull @returns {Vec3} */
export const endOf = ({ at, by }) => along(at, by, 1);
