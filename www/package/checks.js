/** Checks of single values, whose errors name them. @module */
import { InputError } from './errors.js';

/** A value as an error names it. @param {unknown} value */
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
