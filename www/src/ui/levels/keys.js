/** The keys of the timeline. */

/** @import { To } from './types.js' */

/** Keys that move along the timeline; a presenter's clicker sends the pages. @type {Record<string, To>} */
const MOVES = { PageUp: -1, PageDown: 1, Home: 'first', End: 'last', ArrowLeft: -1, ArrowRight: 1 };
/** Further keys that do so while the range has the focus. @type {Record<string, To>} */
const UPRIGHT = { ArrowUp: 1, ArrowDown: -1 };

/**
 * Returns where a key moves the timeline; null for a key without a meaning here.
 * @param {Pick<KeyboardEvent, 'key' | 'shiftKey' | 'altKey' | 'ctrlKey' | 'metaKey'>} event @param {boolean} onRange
 * @returns {To | null}
 */
export function moveOf({ key, shiftKey, altKey, ctrlKey, metaKey }, onRange) {
  if (ctrlKey || metaKey || shiftKey || altKey) return null;
  if (Object.hasOwn(MOVES, key)) return MOVES[key];
  return onRange && Object.hasOwn(UPRIGHT, key) ? UPRIGHT[key] : null;
}

/** Controls that use these keys themselves. */
const BUSY = 'input:not([type=range]), select, textarea, [contenteditable], .code-host, [role=menu] *';
/** The timeline's part of the page, and the parts where nothing that uses keys has the focus. */
const OWN = '.panel-levels';
const NEUTRAL = 'body, .canvas-host';

/**
 * Returns whether a key is meant for the timeline: the focus is there, or on nothing that needs keys.
 * @param {KeyboardEvent} event
 */
export function isMeant(event) {
  const { target, key, defaultPrevented } = event;
  if (defaultPrevented || !(target instanceof Element) || target.matches(BUSY)) return false;
  if (document.querySelector('dialog[open], [popover]:popover-open:not(.explain)')) return false;
  // Space belongs to the control that has the focus.
  if (key === ' ' && target.matches('button, summary, a, label')) return false;
  return target.matches(NEUTRAL) || target.closest(OWN) !== null;
}
