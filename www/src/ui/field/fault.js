/** Describes the error in a formula and its possible repairs, or returns a hint while the formula is unfinished. */
import { questionOf } from '../meant.js';

/**
 * @import { FieldFault } from '../../engine/types.js'
 * @import { FaultView, Meant, Repair } from './types.js'
 */

/** Number of characters of context around an error. */
const CONTEXT = 22;
/** Most characters of a whole formula on a button. */
const LONGEST_FORMULA = 60;

/**
 * @param {string} formula
 * @param {FieldFault | null} fault
 * @param {readonly Meant[]} [meant]  the surfaces that the text names
 * @returns {FaultView | null}
 */
export function describeFault(formula, fault, meant = []) {
  if (meant.length > 0) {
    const repairs = meant.map(({ id, name }) => ({ label: `Show the ${name}`, surface: id }));
    return { tone: 'hint', message: questionOf(meant), excerpt: null, repairs };
  }
  if (formula.trim() === '') {
    return {
      tone: 'hint',
      message: 'Type a formula in x, y and z, such as x^2 + y^2 + z^2 = 1. The last surface stays until then.',
      excerpt: null,
      repairs: [],
    };
  }
  if (!fault) return null;
  const start = Math.min(Math.max(0, fault.start), formula.length);
  const end = Math.min(Math.max(start, fault.end), formula.length);
  /** @type {Repair[]} */
  const repairs = fault.name === null ? [] : [{ label: `Add slider ${fault.name}`, declare: fault.name }];
  /** @param {string} marked @param {string} text */
  const labelOf = (marked, text) =>
    marked === formula.trimEnd() && marked !== ''
      ? `Write as ${shorten(text, LONGEST_FORMULA)}`
      : marked === ''
        ? `Insert ${shorten(text)}`
        : text === ''
          ? `Remove ${shorten(marked)}`
          : `Change to ${shorten(text)}`;
  const choices = fault.choices ?? [];
  repairs.unshift(
    ...choices.map((text) => ({ label: labelOf(formula.slice(start, end), text), replace: { start, end, text } })),
  );
  const mending = fault.suggestion;
  if (mending !== null) {
    const label = labelOf(formula.slice(start, end), mending);
    const { mended } = fault;
    repairs.unshift(
      mended
        ? { label: `${label}, in all ${mended.places} places`, replace: changeBetween(formula, mended.text) }
        : // An ellipsis stands for text that the user has to fill in.
          { label, replace: { start, end, text: mending.replace('…', '') } },
    );
  }
  return { tone: 'fault', message: fault.message, excerpt: excerptOf(formula, start, end), repairs };
}

/**
 * Returns the shortest change that turns one text into another, so that the caret stays near it.
 * @param {string} from
 * @param {string} to
 */
export function changeBetween(from, to) {
  const most = Math.min(from.length, to.length);
  let start = 0;
  while (start < most && from[start] === to[start]) start += 1;
  let same = 0;
  while (same < most - start && from[from.length - 1 - same] === to[to.length - 1 - same]) same += 1;
  return { start, end: from.length - same, text: to.slice(start, to.length - same) };
}

/**
 * Returns the part of the formula at an error, with some context on both sides.
 * @param {string} formula
 * @param {number} start
 * @param {number} end
 */
export function excerptOf(formula, start, end) {
  const from = Math.max(0, start - CONTEXT);
  const stop = Math.min(end, start + 2 * CONTEXT);
  const to = Math.min(formula.length, stop + CONTEXT);
  return {
    before: (from > 0 ? '…' : '') + formula.slice(from, start),
    marked: formula.slice(start, stop) + (stop < end ? '…' : ''),
    after: formula.slice(Math.max(end, stop), to) + (to < formula.length ? '…' : ''),
  };
}

/** @param {string} text @param {number} [longest] */
const shorten = (text, longest = 24) => (text.length > longest ? `${text.slice(0, longest - 1)}…` : text);
