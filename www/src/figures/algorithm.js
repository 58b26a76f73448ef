/** The paper's algorithm as a list of lines, of which the present one is highlighted. */
import { h } from '../ui/dom.js';
import { ALGORITHM } from './words.js';

/** @param {number} now  the live line; −1 for none @param {typeof ALGORITHM} [lines] */
export const algorithmList = (now, lines = ALGORITHM) =>
  h(
    'ol',
    { class: 'algorithm' },
    lines.map(({ depth, text }, k) =>
      h('li', { 'data-depth': depth, 'aria-current': k === now ? 'step' : null }, text),
    ),
  );
