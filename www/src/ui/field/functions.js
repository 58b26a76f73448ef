/** Shows the functions that a formula may use, from the core's description. */

import { button } from '../button.js';
import { createDialog } from '../dialog.js';
import { h } from '../dom.js';

/** @import { Description } from '../../engine/types.js' */

/** What a formula may have besides the functions, a paragraph each. */
const SYNTAX = [
  'Write f(x, y, z) or an equation. A product needs no sign: 2x y. Powers: x^2 or x². Unknown names become sliders. 1/2x is (1/2)x.',
  'Definitions come before the surface, each ends with a ; or its line: r = hypot(x, y); (r - 1)^2 + z^2 = 0.1. Functions, too: f(a, b) = a^2 + b^2. Shift Enter begins a line. Comments: // …, # …, /* … */.',
  'Conditions compare by <, <=, > and >=, with and, or, not: x < 1 and y > 0 ? a : b. The remainder is a % b.',
  'There are no vectors: hypot(x, z) is length(p.xz). Formulas of LaTeX, MATLAB, Python, GLSL and Mathematica are read where they have the same meaning here.',
];

/** @type {ReturnType<typeof createDialog> | null} */
let dialog = null;

/**
 * @param {Description} description
 * @param {(name: string) => void} insert
 */
export function openFunctions(description, insert) {
  dialog ??= createDialog(
    'Formula syntax',
    SYNTAX.map((line) => h('p', { class: 'quiet' }, line)),
    h(
      'ul',
      { class: 'functions' },
      description.functions.map(({ name, signature, help }) =>
        h(
          'li',
          null,
          button(
            {
              class: 'plain small',
              press: () => {
                dialog?.close();
                insert(name);
              },
            },
            h('code', null, signature),
          ),
          h('span', { class: 'quiet' }, help),
        ),
      ),
    ),
  );
  dialog.open();
}
