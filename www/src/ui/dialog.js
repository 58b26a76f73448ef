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
  // A press on the backdrop closes the dialog. Its padding has the same target, and so does a click that begins in the
  // dialog and ends outside, as when text is selected.
  const isBeyond = (/** @type {MouseEvent} */ { target, clientX: x, clientY: y }) => {
    const { left, right, top, bottom } = element.getBoundingClientRect();
    return target === element && (x < left || x > right || y < top || y > bottom);
  };
  let wasBeyond = false;
  element.addEventListener('pointerdown', (event) => {
    wasBeyond = isBeyond(event);
  });
  element.addEventListener('click', (event) => {
    if (wasBeyond && isBeyond(event)) element.close();
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
