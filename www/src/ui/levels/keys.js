/** The keys of the timeline. */

/** @import { Move } from './types.js' */

/** Keys that move along the chosen grain; a presenter's clicker sends the pages. @type {Record<string, Move['to']>} */
const MOVES = { PageUp: -1, PageDown: 1, Home: 'first', End: 'last' };
/** @type {Record<string, -1 | 1>} */
const ARROWS = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: 1, ArrowDown: -1 };

/**
 * Returns the move of a key; null for one that means nothing here. An arrow alone moves by an event, on the range by
 * what the range goes along, with Shift by a particle, with Alt by a level.
 * @param {Pick<KeyboardEvent, 'key' | 'shiftKey' | 'altKey' | 'ctrlKey' | 'metaKey'>} event
 * @param {{ onRange: boolean, isOpen: boolean }} place  `isOpen`: a particle is followed
 * @returns {Move | null}
 */
export function moveOf({ key, shiftKey, altKey, ctrlKey, metaKey }, { onRange, isOpen }) {
  if (ctrlKey || metaKey) return null;
  const plain = !shiftKey && !altKey;
  if (Object.hasOwn(MOVES, key)) return plain ? { grain: 'chosen', to: MOVES[key] } : null;
  const to = Object.hasOwn(ARROWS, key) ? ARROWS[key] : null;
  const isUpright = key === 'ArrowUp' || key === 'ArrowDown';
  if (to === null || (isUpright && !(onRange && plain))) return null;
  if (altKey) return shiftKey ? null : { grain: 'level', to };
  if (shiftKey) return { grain: 'particle', to };
  return { grain: onRange || !isOpen ? 'chosen' : 'event', to };
}

/** Controls that have uses of their own for these keys. */
const BUSY = 'input:not([type=range]), select, textarea, [contenteditable], .code-host, [role=menu] *';
/** The parts of the page that belong to the timeline, and those where nothing else is chosen. */
const OWN = '.panel-levels, .panel-follow';
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
