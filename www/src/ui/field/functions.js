/** Shows the functions available in a formula, from the core's description. */

import { button } from '../button.js';
import { createDialog } from '../dialog.js';
import { h, marked } from '../dom.js';

/** @import { Description } from '../../engine/types.js' */

/** The rules of the language besides its functions, a paragraph each. */
const SYNTAX = [
  'Write a function of x, y and z, or an equation. A product needs no sign: `2x y`. Powers: `x^2` or `x²`. `1/2x` is `(1/2)x`. Unknown names become sliders.',
  'Definitions stand before the surface, each ended by a `;` or by its line: `r = hypot(x, y); (r - 1)^2 + z^2 = 0.1`. Functions, too: `f(a, b) = a^2 + b^2`. Shift Enter begins a line. Comments: `// …`, `# …`, `/* … */`.',
  'Conditions compare with `<`, `<=`, `>` and `>=`, joined by `and`, `or`, `not`: `x < 1 and y > 0 ? a : b`. In braces after the formula they limit the surface: `z = x*y {x^2 + y^2 < 1}`. The remainder is `a % b`.',
  'There are no vectors: write `hypot(x, z)` for `length(p.xz)`. Formulas of LaTeX, MATLAB, Python, GLSL and Mathematica are read where they mean the same here.',
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
    h(
      'div',
      { class: 'syntax' },
      SYNTAX.map((line) => h('p', { class: 'quiet' }, marked(line))),
    ),
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
