/**
 * Manages the layout: folding and hiding of panels, the tabs of the compact layout, and the free area for the picture.
 */
import { h } from './dom.js';
import { explain } from './explain.js';
import { icon } from './icons.js';

/** Width below which the report is initially folded, to leave room for the picture. */
const NARROW = '(max-width: 67.45em)';
/** Width of a phone in portrait orientation, with panels and tabs below the picture. */
const COMPACT = '(max-width: 44.95em)';

/**
 * What is hidden: `panels` leaves the picture with caption and timeline, to be presented.
 * @typedef {'nothing' | 'panels' | 'all'} Hidden
 */
/**
 * A panel with a `head` can be folded.
 * @typedef {{ id: string, title: string, panel: HTMLElement, head?: HTMLElement }} Panel
 */

/**
 * @param {object} parts
 * @param {HTMLElement} parts.shell
 * @param {HTMLElement} parts.view
 * @param {HTMLElement} parts.nav
 * @param {Panel[]} parts.panels
 * @param {() => number} parts.covered  pixels at the bottom of the view that something else than panels covers
 * @param {(insets: { top: number, right: number, bottom: number, left: number }) => void} parts.inset
 */
export function mountLayout({ shell, view, nav, panels, covered, inset }) {
  const folds = panels.flatMap(({ title, panel, head }) => (head ? [createFold(title, panel, head)] : []));
  if (matchMedia(NARROW).matches) folds.at(-1)?.set(true);

  const tabs = panels.map(({ title, panel }) =>
    h(
      'button',
      {
        type: 'button',
        class: 'button tab',
        'aria-controls': panel.id,
        'aria-expanded': 'false',
        on: { click: () => toggle(panel) },
      },
      title,
    ),
  );
  nav.append(...tabs);

  /** @param {HTMLElement | null} active */
  function activate(active) {
    panels.forEach(({ panel }, i) => {
      panel.toggleAttribute('data-active', panel === active);
      tabs[i].setAttribute('aria-expanded', String(panel === active));
    });
  }
  /** @param {HTMLElement} panel */
  function toggle(panel) {
    activate(panel.hasAttribute('data-active') ? null : panel);
  }
  activate(panels[0].panel);

  const unhide = h(
    'button',
    { type: 'button', class: 'button unhide', on: { click: () => hide('nothing') } },
    'Show the panels',
  );
  view.append(unhide);
  /** @param {Hidden} hidden */
  function hide(hidden) {
    if (hidden === 'nothing') delete shell.dataset.hidden;
    else shell.dataset.hidden = hidden;
    const { activeElement: active } = document;
    // The focus does not stay on what is hidden.
    if (active instanceof HTMLElement && active !== document.body && active.offsetParent === null) unhide.focus();
  }

  const compact = matchMedia(COMPACT);
  const measure = () => {
    const { left, top, right, bottom } = view.getBoundingClientRect();
    // On a phone the tools and the legend would cover the surface, so their areas are not free.
    const side = (/** @type {string} */ part) =>
      (compact.matches && view.querySelector(part)) || { clientWidth: 0, clientHeight: 0 };
    inset({
      left,
      top: top + side('.legend').clientHeight,
      right: innerWidth - right + side('.toolbar').clientWidth,
      bottom: innerHeight - bottom + covered(),
    });
  };
  const sizes = new ResizeObserver(measure);
  sizes.observe(view);
  addEventListener('resize', measure);
  measure();

  return {
    /** Updates the free area whenever a part of the view changes its size. @param {HTMLElement} part */
    follow: (part) => sizes.observe(part),
    measure,
    /** Hides the panels; then caption and timeline, too; then nothing. */
    hideMore: () => hide(shell.dataset.hidden === 'all' ? 'nothing' : shell.dataset.hidden ? 'all' : 'panels'),
  };
}

/** @param {string} title @param {HTMLElement} panel @param {HTMLElement} head */
function createFold(title, panel, head) {
  const button = h('button', { type: 'button', class: 'button plain square fold', 'aria-controls': panel.id });
  let folded = false;
  /** @param {boolean} next */
  const set = (next) => {
    folded = next;
    panel.toggleAttribute('data-folded', folded);
    button.setAttribute('aria-expanded', String(!folded));
    button.setAttribute('aria-label', folded ? `Unfold ${title.toLowerCase()}` : `Fold ${title.toLowerCase()}`);
    button.replaceChildren(icon(folded ? 'unfold' : 'fold'));
  };
  button.addEventListener('click', () => set(!folded));
  explain(button, () => ({ text: folded ? 'Unfold' : 'Fold' }));
  set(false);
  head.append(button);
  return { set };
}
