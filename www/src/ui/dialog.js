/** Creates modal dialogs with a title and a close button. */
import { button } from './button.js';
import { h, uniqueId } from './dom.js';

/** @import { Children } from './types.js' */

/**
 * @param {string} title
 * @param {...Children} content
 */
export function createDialog(title, ...content) {
  const id = uniqueId('dialog');
  const element = h(
    'dialog',
    { class: 'dialog', 'aria-labelledby': id },
    h(
      'div',
      { class: 'dialog-head' },
      h('h2', { id }, title),
      button({ icon: 'close', 'aria-label': 'Close', press: () => element.close() }),
    ),
    content,
  );
  // A press on the backdrop closes the dialog.
  element.addEventListener('click', (event) => {
    if (event.target === element) element.close();
  });
  document.body.append(element);
  return {
    element,
    open: () => {
      if (!element.open) element.showModal();
    },
    close: () => element.close(),
  };
}
