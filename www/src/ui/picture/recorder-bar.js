/** The bar that is shown while a film is recorded: for how long, or how much of it, and a button that ends it. */
import { h } from '../dom.js';
import { formatShare } from '../format.js';

/** @param {() => void} stop */
export function createRecorderBar(stop) {
  const text = h('span', { class: 'recorder-text' });
  const button = h('button', { type: 'button', class: 'button small', on: { click: stop } }, 'Stop recording');
  const element = h(
    'div',
    { class: 'recorder', role: 'group', 'aria-label': 'Recording' },
    h('span', { class: 'recorder-dot', 'aria-hidden': 'true' }),
    text,
    button,
  );
  document.body.append(element);
  const had = document.activeElement;
  button.focus();
  return {
    /** @param {number | null} share @param {number} seconds */
    tell(share, seconds) {
      text.textContent = share === null ? `${seconds.toFixed(1)}\u202fs` : formatShare(share, 0);
    },
    remove() {
      const hadFocus = element.contains(document.activeElement);
      element.remove();
      if (hadFocus && had instanceof HTMLElement) had.focus();
    },
  };
}
