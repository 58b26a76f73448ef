/** Creates tables of figures. */
import { h } from './dom.js';

/** @import { TableContent } from './types.js' */

/** @param {TableContent} about */
export const tableOf = ({ head: [first, ...rest], rows, caption, class: kind }) =>
  h(
    'table',
    { class: kind ?? null },
    caption ? h('caption', null, caption) : null,
    h(
      'thead',
      null,
      h(
        'tr',
        null,
        first ? h('th', { scope: 'col' }, first) : h('td'),
        rest.map((name) => h('th', { scope: 'col' }, name)),
      ),
    ),
    h(
      'tbody',
      null,
      rows.map(([name, ...cells]) =>
        h(
          'tr',
          null,
          h('th', { scope: 'row' }, name),
          cells.map((cell) => h('td', null, cell)),
        ),
      ),
    ),
  );
