/** The bar shown while a film is recorded: its time or its progress, and a button to stop. */
import { button } from '../button.js';
import { h } from '../dom.js';
import { formatShare } from '../format.js';

/** @param {() => void} stop */
export function createRecorderBar(stop) {
  const text = h('span', { class: 'recorder-text' });
  const end = button({ class: 'small', press: stop }, 'Stop recording');
  const element = h(
    'div',
    { class: 'recorder', role: 'group', 'aria-label': 'Recording' },
    h('span', { class: 'recorder-dot', 'aria-hidden': 'true' }),
    text,
    end,
  );
  document.body.append(element);
  const had = document.activeElement;
  end.focus();
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
