/** What is wrong with a formula, in words and as repairs. Pure: the elements are built elsewhere. */

/** @typedef {import('../../engine/types.js').FieldFault} FieldFault */
/**
 * @typedef {object} FaultView
 * @property {'hint' | 'fault'} tone
 * @property {string} message
 * @property {{ before: string, marked: string, after: string } | null} excerpt
 * @property {Repair[]} repairs
 */
/** @typedef {{ label: string, declare?: string, replace?: { start: number, end: number, text: string } }} Repair */

/** Characters of context around the place of an error. */
const CONTEXT = 22;

/**
 * @param {string} formula
 * @param {FieldFault | null} fault
 * @returns {FaultView | null}
 */
export function describeFault(formula, fault) {
  if (formula.trim() === '') {
    return { tone: 'hint', message: 'Type a formula in x, y and z, such as x^2 + y^2 + z^2 = 1. The last surface stays until then.', excerpt: null, repairs: [] };
  }
  if (!fault) return null;
  const start = Math.min(Math.max(0, fault.start), formula.length);
  const end = Math.min(Math.max(start, fault.end), formula.length);
  /** @type {Repair[]} */
  const repairs = fault.names.map((name) => ({ label: `Add slider ${name}`, declare: name }));
  if (fault.suggestion) {
    repairs.unshift({ label: `Change to ${shorten(fault.suggestion)}`, replace: { start, end, text: fault.suggestion } });
  }
  return { tone: 'fault', message: fault.message, excerpt: excerptOf(formula, start, end), repairs };
}

/**
 * The place of the error with a little of the formula on both sides.
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

/** @param {string} text */
const shorten = (text) => (text.length > 24 ? `${text.slice(0, 23)}…` : text);
