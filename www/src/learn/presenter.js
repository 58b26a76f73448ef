/** Presenting: one stop at a time, in large type, with the keys of a clicker. The stop stays in the address. */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { h } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { PresenterOptions } from './types.js'
 */

/** Elements in which a letter is text. */
const TYPING = 'input:not([type="range"], [type="radio"], [type="checkbox"]), textarea, select';

/** @param {PresenterOptions} about */
export function createPresenter({ stops, to }) {
  const root = document.documentElement;
  /** Number of the stop that is shown; null while nothing is presented. */
  /** @type {Signal<number | null>} */
  const at = signal(null);
  const withNotes = signal(false);
  let last = 0;
  const leave = () => {
    if (document.fullscreenElement) void document.exitFullscreen();
    to(stops[last], false);
  };
  const toggleNotes = () => {
    withNotes.value = root.toggleAttribute('data-notes');
  };
  const step = (/** @type {number} */ by) => to(stops[Math.min(stops.length - 1, Math.max(0, last + by))], true);
  const bar = h(
    'nav',
    { class: 'present-bar', 'aria-label': 'Presentation', hidden: () => at.value === null },
    button({ icon: 'back', 'aria-label': 'Previous stop', press: () => step(-1) }),
    h('p', { class: 'present-place', 'aria-live': 'polite' }, () =>
      at.value === null ? '' : `${formatCount(at.value + 1)} of ${formatCount(stops.length)}`,
    ),
    button({ icon: 'forward', 'aria-label': 'Next stop', press: () => step(1) }),
    button({ class: 'plain', 'aria-pressed': () => String(withNotes.value), press: toggleNotes }, 'Notes'),
    button({ class: 'plain', press: toggleFull }, 'Full screen'),
    button({ class: 'plain', press: leave }, 'Leave'),
  );
  document.body.append(bar);
  listen(
    { PageDown: () => step(1), PageUp: () => step(-1), Escape: leave, n: toggleNotes, f: toggleFull },
    () => at.peek() !== null,
  );
  return {
    /** Shows one stop alone. @param {string} stop */
    show(stop) {
      last = Math.max(0, stops.indexOf(stop));
      at.value = last;
      root.dataset.mode = 'present';
      setCurrent(document.getElementById(stop));
      scrollTo(0, 0);
    },
    /** Goes back to the article. */
    end() {
      at.value = null;
      delete root.dataset.mode;
    },
  };
}

/** Marks the stop that is shown, and the chapter around it. @param {HTMLElement | null} stop */
function setCurrent(stop) {
  for (const marked of document.querySelectorAll('[data-current]')) marked.removeAttribute('data-current');
  const chapter = stop?.closest('.chapter');
  for (const shown of [stop, chapter]) shown?.setAttribute('data-current', '');
  // A question stands alone with the figure of its chapter; the chapter itself is its title and its figure.
  chapter?.toggleAttribute('data-asks', stop?.matches('.predict'));
}

/** Fills the screen, or leaves it. A browser may refuse; the presentation goes on in the window. */
function toggleFull() {
  if (document.fullscreenElement) void document.exitFullscreen();
  else document.documentElement.requestFullscreen?.().catch(() => {});
}

/**
 * Takes the keys of the presentation.
 * @param {Record<string, () => void>} keys
 * @param {() => boolean} isOn
 */
function listen(keys, isOn) {
  addEventListener(
    'keydown',
    (event) => {
      if (!isOn() || event.ctrlKey || event.metaKey || event.altKey) return;
      const isText = event.target instanceof Element && event.target.matches(TYPING);
      const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!act || (isText && event.key.length === 1)) return;
      event.preventDefault();
      event.stopPropagation();
      act();
    },
    true,
  );
}
