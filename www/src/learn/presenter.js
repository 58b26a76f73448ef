/** Presenting: one stop at a time, in large type, with the keys of a clicker. The stop stays in the address. */
import { h } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { icon } from '../ui/icons.js';

/** Elements in which a letter is text. */
const TYPING = 'input:not([type="range"], [type="radio"], [type="checkbox"]), textarea, select';

/**
 * @param {object} about
 * @param {readonly string[]} about.stops  ids of elements, in their order
 * @param {(stop: string, isPresenting: boolean) => void} about.to  leads the address to a stop
 */
export function createPresenter({ stops, to }) {
  const root = document.documentElement;
  let at = 0;
  const place = h('p', { class: 'present-place', 'aria-live': 'polite' });
  const notes = h(
    'button',
    { type: 'button', class: 'button plain', 'aria-pressed': 'false', on: { click: () => toggleNotes() } },
    'Notes',
  );
  const square = (/** @type {string} */ label, /** @type {'back' | 'forward'} */ name, /** @type {number} */ by) =>
    h(
      'button',
      { type: 'button', class: 'button plain square', 'aria-label': label, on: { click: () => step(by) } },
      icon(name),
    );
  const bar = h(
    'nav',
    { class: 'present-bar', 'aria-label': 'Presentation', hidden: true },
    square('Previous stop', 'back', -1),
    place,
    square('Next stop', 'forward', 1),
    notes,
    h('button', { type: 'button', class: 'button plain', on: { click: () => toggleFull() } }, 'Full screen'),
    h('button', { type: 'button', class: 'button plain', on: { click: () => leave() } }, 'Leave'),
  );
  document.body.append(bar);

  const isOn = () => root.dataset.mode === 'present';
  const step = (/** @type {number} */ by) => to(stops[Math.min(stops.length - 1, Math.max(0, at + by))], true);
  const leave = () => {
    if (document.fullscreenElement) void document.exitFullscreen();
    to(stops[at], false);
  };
  function toggleNotes() {
    const shown = root.toggleAttribute('data-notes');
    notes.setAttribute('aria-pressed', String(shown));
  }
  function toggleFull() {
    // A browser may refuse; the presentation goes on in the window.
    if (document.fullscreenElement) void document.exitFullscreen();
    else root.requestFullscreen?.().catch(() => {});
  }

  /** @type {Record<string, () => void>} */
  const keys = {
    PageDown: () => step(1),
    PageUp: () => step(-1),
    Escape: leave,
    n: toggleNotes,
    f: toggleFull,
  };
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

  return {
    /** Shows one stop alone. @param {string} stop */
    show(stop) {
      at = Math.max(0, stops.indexOf(stop));
      root.dataset.mode = 'present';
      bar.hidden = false;
      for (const marked of document.querySelectorAll('[data-current]')) marked.removeAttribute('data-current');
      const element = document.getElementById(stop);
      for (const shown of [element, element?.closest('.chapter')]) shown?.setAttribute('data-current', '');
      // A question stands alone with the figure of its chapter; the chapter itself is its title and its figure.
      element?.closest('.chapter')?.toggleAttribute('data-asks', element.matches('.predict'));
      place.textContent = `${formatCount(at + 1)} of ${formatCount(stops.length)}`;
      scrollTo(0, 0);
    },
    /** Goes back to the article. */
    end() {
      delete root.dataset.mode;
      bar.hidden = true;
    },
  };
}
