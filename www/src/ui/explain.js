/**
 * Shows explanations of figures and controls in one shared popover, on hover, on keyboard focus and on tap. Escape
 * dismisses the popover, and it stays while the pointer is on it (WCAG 1.4.13).
 */
import { clamp } from '../engine/vector.js';
import { fill, h, usesKeyboard } from './dom.js';

/** @import { Explanation, Side } from './types.js' */

const HOVER_DELAY_MS = 350;
const LEAVE_DELAY_MS = 120;
const MARGIN_PX = 8;

/** @type {HTMLDivElement | null} */
let popover = null;
/** @type {Element | null} */
let owner = null;
/**
 * The element that the explanation describes for assistive technology: the anchor, or the control inside it.
 * @type {Element | null}
 */
let described = null;
let timer = 0;

function ensure() {
  if (popover) return popover;
  const made = h('div', { class: 'explain', id: 'explain', role: 'tooltip', popover: 'manual' });
  made.addEventListener('pointerenter', () => clearTimeout(timer));
  made.addEventListener('pointerleave', () => later(hide, LEAVE_DELAY_MS));
  document.body.append(made);
  addEventListener(
    'keydown',
    (event) => {
      if (event.key === 'Escape' && owner) {
        hide();
        event.stopPropagation();
      }
    },
    true,
  );
  addEventListener('scroll', hide, { capture: true, passive: true });
  addEventListener('resize', hide);
  popover = made;
  return made;
}

/** @param {() => void} act @param {number} delayMs */
function later(act, delayMs) {
  clearTimeout(timer);
  timer = window.setTimeout(act, delayMs);
}

function hide() {
  clearTimeout(timer);
  if (described?.getAttribute('aria-describedby') === 'explain') described.removeAttribute('aria-describedby');
  owner = null;
  described = null;
  if (popover?.matches(':popover-open')) popover.hidePopover();
}

/** @param {Element} anchor @param {Explanation} explanation @param {Side} [side] */
function show(anchor, explanation, side) {
  clearTimeout(timer);
  const element = ensure();
  if (owner !== anchor) hide();
  owner = anchor;
  fill(
    element,
    explanation.title ? h('strong', null, explanation.title) : null,
    explanation.text,
    explanation.ideal ? h('span', { class: 'ideal' }, explanation.ideal) : null,
  );
  described =
    document.activeElement !== null && anchor.contains(document.activeElement) ? document.activeElement : anchor;
  if (!described.hasAttribute('aria-describedby')) described.setAttribute('aria-describedby', 'explain');
  if (!element.matches(':popover-open')) element.showPopover();
  placeExplanation(element, anchor, side);
}

/**
 * Places a popover below its anchor, or above or to the left of it if requested and possible.
 * @param {HTMLElement} element
 * @param {DOMRect} anchor
 * @param {Side} [side]
 */
export function place(element, anchor, side = 'below') {
  const { width, height } = element.getBoundingClientRect();
  const beside = anchor.left - width - MARGIN_PX;
  const left = side === 'left' && beside >= MARGIN_PX;
  const [above, below] = [anchor.top - height - MARGIN_PX / 2, anchor.bottom + MARGIN_PX / 2];
  const over = side === 'above' ? above >= MARGIN_PX : below + height > innerHeight - MARGIN_PX;
  const y = left ? anchor.top : over ? clear(above, height) : below;
  const x = left ? beside : anchor.left;
  element.style.left = `${clamp(x, MARGIN_PX, Math.max(MARGIN_PX, innerWidth - width - MARGIN_PX))}px`;
  element.style.top = `${clamp(y, MARGIN_PX, Math.max(MARGIN_PX, innerHeight - height - MARGIN_PX))}px`;
}

/**
 * Returns the top of a popover, moved above the timeline if the popover would cover it.
 * @param {number} top @param {number} height
 */
function clear(top, height) {
  const track = document.querySelector('.levels-track')?.getBoundingClientRect();
  const isOver = track && track.height > 0 && top < track.bottom && top + height > track.top;
  return isOver ? Math.max(MARGIN_PX, track.top - height - MARGIN_PX / 2) : top;
}

/**
 * Places an explanation like a popover. If it would cover charts, it is moved into its anchor's panel or else above the
 * charts.
 * @param {HTMLElement} element @param {Element} anchor @param {Side} [side]
 */
function placeExplanation(element, anchor, side) {
  place(element, anchor.getBoundingClientRect(), side);
  const charts = document.querySelector('.levels-charts')?.getBoundingClientRect();
  if (!charts) return;
  const isOver = () => {
    const own = element.getBoundingClientRect();
    const isBeside = own.right <= charts.left || own.left >= charts.right;
    return !isBeside && own.bottom > charts.top && own.top < charts.bottom;
  };
  if (!isOver()) return;
  const { width, height } = element.getBoundingClientRect();
  const panel = anchor.closest('.panel')?.getBoundingClientRect();
  if (side !== 'left' && panel) {
    element.style.left = `${Math.max(MARGIN_PX, panel.right - width)}px`;
    if (!isOver()) return;
    place(element, anchor.getBoundingClientRect(), side);
  }
  element.style.top = `${Math.max(MARGIN_PX, charts.top - height - MARGIN_PX / 2)}px`;
}

/**
 * Attaches an explanation to `target`, and returns that.
 * @template {Element} E
 * @param {E} target hovered or focused
 * @param {() => Explanation | null} read
 * @param {{ tap?: boolean, side?: Side, focus?: boolean }} [options] with `tap`, a press toggles it (for elements that
 *   do nothing else; a press on an unavailable one always shows it); without `focus` it is there for the pointer alone,
 *   where Escape has another use
 */
export function explain(target, read, options = {}) {
  const open = () => {
    const explanation = read();
    if (explanation?.text && target.isConnected) show(target, explanation, options.side);
  };
  target.addEventListener('pointerenter', (event) => {
    if (event instanceof PointerEvent && event.pointerType === 'mouse') later(open, owner ? 60 : HOVER_DELAY_MS);
  });
  target.addEventListener('pointerleave', () => later(hide, LEAVE_DELAY_MS));
  target.addEventListener('pointerdown', () => {
    if (!options.tap) hide();
  });
  target.addEventListener('focusin', () => {
    // Focus may return from a closing menu, and no popover can be shown while another one is being hidden.
    if (usesKeyboard() && options.focus !== false) later(open, 0);
  });
  target.addEventListener('focusout', hide);
  target.addEventListener('click', () => {
    if (options.tap) return owner === target ? hide() : open();
    // A press on what is unavailable does nothing else than say why.
    if (target.getAttribute('aria-disabled') === 'true') open();
  });
  return target;
}
