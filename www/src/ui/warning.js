/** Shows a warning: its first sentence, which says what happened and what to do, and the others on a press. */
import { h } from './dom.js';
import { sentencesOf } from './segments.js';

/** @param {string} text */
export function createWarning(text) {
  const { first, rest } = sentencesOf(text);
  return h('li', null, rest ? h('details', null, h('summary', null, first), rest) : first);
}
