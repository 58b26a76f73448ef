/** Checks of single values. Their errors name the value. @module */
import { InputError } from './errors.js';

/** A value in the words of an error. @param {unknown} value */
export const shown = (value) => (typeof value === 'string' ? `“${value.slice(0, 40)}”` : String(value));

/** @type {(name: string, value: unknown, is: (v: number) => boolean, what: string) => number} */
export function number(name, value, is, what) {
  if (typeof value === 'number' && Number.isFinite(value) && is(value)) return value;
  throw new InputError(`${name}: ${what}, not ${shown(value)}.`);
}

/** @param {string} name @param {unknown} value @param {readonly string[]} choices */
export function choice(name, value, choices) {
  if (choices.includes(/** @type {string} */ (value))) return /** @type {string} */ (value);
  throw new InputError(`${name}: one of ${choices.join(', ')}, not ${shown(value)}.`);
}

/** @param {string} name @param {unknown} value */
export function flag(name, value) {
  if (typeof value !== 'boolean') throw new InputError(`${name}: true or false, not ${shown(value)}.`);
  return value;
}

/**
 * Three coordinates per point, in double precision.
 * @param {string} name @param {unknown} value
 */
export function vectors(name, value) {
  if (typeof value === 'string')
    throw new InputError(`${name}: numbers, or the bytes of a file, and not its name ${shown(value)}.`);
  const isArray = Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));
  const rows = Array.isArray(value) && Array.isArray(value[0]) ? value.flat() : value;
  const all = isArray ? Float64Array.from(/** @type {ArrayLike<number>} */ (rows), Number) : null;
  if (all === null || all.length === 0 || all.length % 3 !== 0)
    throw new InputError(`${name}: an array of numbers, x, y and z of each point, or one of [x, y, z].`);
  const wrong = all.findIndex((v) => !Number.isFinite(v));
  if (wrong >= 0) throw new InputError(`${name}[${wrong}]: a number, not ${shown(all[wrong])}.`);
  return all;
}
