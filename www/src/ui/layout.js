/**
 * Manages the layout: folding and hiding of panels, the tabs of the compact layout, and the free area for the picture.
 */
import { signal } from '@preact/signals-core';
import { button } from './button.js';
import { live } from './dom.js';
import { explain } from './explain.js';
import { remembered } from './remembered.js';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { LayoutOptions } from './types.js'
 */

/** Width up to which the page is laid out for a phone: panels and tabs below the picture. */
const COMPACT = '(max-width: 44.95em)';

/**
 * The hidden part of the page: `panels` leaves picture, caption and timeline, for presenting.
 * @typedef {'nothing' | 'panels' | 'all'} Hidden
 */

/** @param {LayoutOptions} parts */
export function mountLayout({ shell, view, nav, panels, notices, covered, inset }) {
  for (const { title, panel, head, folded = false } of panels) if (head) addFold(title, panel, head, folded);

  /** @type {Signal<HTMLElement | null>} */
  const active = signal(panels[0].panel);
  for (const { title, panel } of panels) {
    live(panel, () => panel.toggleAttribute('data-active', panel === active.value));
    nav.append(
      button(
        {
          class: 'tab',
          'aria-controls': panel.id,
          'aria-expanded': () => String(panel === active.value),
          press: () => {
            active.value = panel === active.peek() ? null : panel;
          },
        },
        title,
      ),
    );
  }

  const unhide = button({ class: 'unhide', press: () => hide('nothing') }, 'Show the panels');
  view.append(unhide);
  /** @param {Hidden} hidden */
  function hide(hidden) {
    if (hidden === 'nothing') delete shell.dataset.hidden;
    else shell.dataset.hidden = hidden;
    const { activeElement: focused } = document;
    // The focus must not stay on a hidden element.
    if (focused instanceof HTMLElement && focused !== document.body && focused.offsetParent === null) unhide.focus();
  }

  const compact = matchMedia(COMPACT);
  const measure = () => {
    const { left, top, right, bottom } = view.getBoundingClientRect();
    const size = (/** @type {string} */ part) => view.querySelector(part) ?? { clientWidth: 0, clientHeight: 0 };
    const [tools, legend] = [size('.toolbar'), size('.legend')];
    // On a phone the tools, the legend and the foot would cover the surface, so their areas are not free. In a larger
    // window only the legend's corner is kept free.
    const [aside, above] = compact.matches ? [tools.clientWidth, legend.clientHeight] : [0, 0];
    const free = { top: top + legend.clientHeight, left, right: innerWidth - right + tools.clientWidth };
    for (const [side, px] of Object.entries(free)) notices.style.setProperty(`--notices-${side}`, `${px}px`);
    const foot = compact.matches ? (view.querySelector('.foot')?.getBoundingClientRect().top ?? bottom) : bottom;
    inset({
      left,
      top: top + above,
      right: innerWidth - right + aside,
      bottom: innerHeight - bottom + Math.max(covered(), bottom - foot),
      corner: { width: legend.clientWidth, height: legend.clientHeight - above },
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
    /** Hides the panels, then also caption and timeline, then shows all again. */
    hideMore: () => hide(shell.dataset.hidden === 'all' ? 'nothing' : shell.dataset.hidden ? 'all' : 'panels'),
  };
}

/** @param {string} title @param {HTMLElement} panel @param {HTMLElement} head @param {boolean} folded  at first */
function addFold(title, panel, head, folded) {
  const name = title.toLowerCase();
  const isFolded = remembered(`fold-${name}`, folded);
  const fold = button({
    class: 'plain square fold',
    icon: () => (isFolded.value ? 'unfold' : 'fold'),
    'aria-controls': panel.id,
    'aria-expanded': () => String(!isFolded.value),
    'aria-label': () => (isFolded.value ? `Unfold ${name}` : `Fold ${name}`),
    press: () => {
      isFolded.value = !isFolded.peek();
    },
  });
  head.append(explain(fold, () => ({ text: isFolded.peek() ? 'Unfold' : 'Fold' })));
  // Without the button, on a phone, nothing is folded.
  panel.addEventListener('click', ({ target }) => {
    if (target instanceof Element && target.matches('.fold-title') && fold.checkVisibility()) fold.click();
  });
  live(panel, () => panel.toggleAttribute('data-folded', isFolded.value));
}
