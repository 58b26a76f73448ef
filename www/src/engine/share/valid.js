/**
 * Checks of untyped input: each returns the nearest valid value, or undefined if there is none.
 *
 * @module
 */

/** @import { Vec3 } from '../types.js' */

/**
 * Limits a number to its range; returns undefined for anything else.
 * @param {unknown} v
 * @param {number} min
 * @param {number} max
 */
export const within = (v, min, max) =>
  typeof v === 'number' && Number.isFinite(v) ? Math.min(max, Math.max(min, v)) : undefined;

/** @param {unknown} v @returns {v is Record<string, unknown>} */
export const isRecord = (v) => typeof v === 'object' && v !== null && !Array.isArray(v);

/** @param {unknown} v */
export const finite = (v) => within(v, -Infinity, Infinity);

/** @param {unknown} v @returns {Vec3 | undefined} */
export const vec3 = (v) =>
  Array.isArray(v) && v.length === 3 && v.every(Number.isFinite) ? [v[0], v[1], v[2]] : undefined;

/** A list of integers from 0 to `most`. @param {unknown} v @param {number} most @returns {number[] | undefined} */
export const integers = (v, most) =>
  Array.isArray(v) && v.every((n) => Number.isInteger(n) && n >= 0 && n <= most) ? [...v] : undefined;
