/** Shows the functions that a formula may use, from the core's description. */

import { button } from '../button.js';
import { createDialog } from '../dialog.js';
import { h } from '../dom.js';

/** @import { Description } from '../../engine/types.js' */

/** @type {ReturnType<typeof createDialog> | null} */
let dialog = null;

/**
 * @param {Description} description
 * @param {(name: string) => void} insert
 */
export function openFunctions(description, insert) {
  dialog ??= createDialog(
    'What a formula may hold',
    h(
      'p',
      { class: 'quiet' },
      'Write f(x, y, z), or an equation. Products may be left out: 2x y. Powers: x^2 or x². Names that are not known become sliders.',
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
