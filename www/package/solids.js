/** Solids that are made of other ones. @module */
import { number, shown } from './checks.js';
import { InputError } from './errors.js';

/**
 * @import { Field, Solid } from './index.js'
 * @import { SentPart } from './protocol.js'
 */

/**
 * How solids are combined, as the core calls it, with the number of operands and the name of the other argument.
 * @type {Record<Solid['join'], {count?: number, by?: string}>}
 */
const JOINS = {
  union: {},
  intersection: {},
  difference: { count: 2 },
  smoothUnion: { count: 2, by: 'width' },
  offset: { count: 1, by: 'distance' },
};

/** @param {object} given @returns {given is Solid} */
export const isSolid = (given) => 'join' in given && !Array.isArray(given) && !ArrayBuffer.isView(given);

/** @param {Solid['join']} join @param {readonly (Field | readonly Field[])[]} solids @returns {Solid} */
const solid = (join, solids) => ({
  join,
  of: /** @type {readonly Field[]} */ (solids.length === 1 && Array.isArray(solids[0]) ? solids[0] : solids),
});

/** @param {(Field | readonly Field[])[]} solids */
export const union = (...solids) => solid('union', solids);
/** @param {(Field | readonly Field[])[]} solids */
export const intersection = (...solids) => solid('intersection', solids);
/** @param {Field} a @param {Field} b @returns {Solid} */
export const difference = (a, b) => ({ join: 'difference', of: [a, b] });
/** @param {Field} a @param {Field} b @param {number} width @returns {Solid} */
export const smoothUnion = (a, b, width) => ({ join: 'smoothUnion', of: [a, b], by: width });
/** @param {Field} a @param {number} distance @returns {Solid} */
export const offset = (a, distance) => ({ join: 'offset', of: [a], by: distance });

/**
 * A combination in the form in which it is sent. `part` gives that of an operand.
 * @param {Solid} given @param {(field: unknown) => SentPart} part
 * @returns {NonNullable<SentPart['solid']>}
 */
export function solidOf({ join, of, by = 0 }, part) {
  const { count, by: name } = JOINS[join] ?? {};
  if (!(join in JOINS)) throw new InputError(`join: one of ${Object.keys(JOINS).join(', ')}, not ${shown(join)}.`);
  if (!Array.isArray(of) || of.length === 0) throw new InputError(`${join}: one solid or more, not none.`);
  if (count !== undefined && of.length !== count)
    throw new InputError(`${join}: ${count === 1 ? 'one solid' : 'two solids'}, not ${of.length}.`);
  if (name !== undefined) {
    const isRight = (/** @type {number} */ v) => join === 'offset' || v >= 0;
    number(`${join}(): ${name}`, by, isRight, join === 'offset' ? 'a number' : 'a number from 0 on');
  }
  return { join, of: of.map(part), by };
}

/** The fields of which a field is made, or the field itself. @param {SentPart} field @returns {SentPart[]} */
export const leavesOf = (field) => (field.solid ? field.solid.of.flatMap(leavesOf) : [field]);
