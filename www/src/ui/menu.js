/** Attaches a menu in the top layer to a button. */
import { h, query, uniqueId } from './dom.js';
import { place } from './explain.js';

/**
 * @param {HTMLButtonElement} button
 * @param {HTMLElement[]} items buttons, or any other content
 * @param {{ label: string }} options
 */
export function attachMenu(button, items, { label }) {
  const id = uniqueId('menu');
  const menu = h('div', { class: 'menu', id, popover: 'auto', role: 'group', 'aria-label': label }, items);
  button.popoverTargetElement = menu;
  button.setAttribute('aria-expanded', 'false');
  menu.addEventListener('toggle', (event) => {
    const open = event.newState === 'open';
    button.setAttribute('aria-expanded', String(open));
    if (!open) return;
    place(menu, button.getBoundingClientRect(), 'left');
    query(menu, 'button, input, select').focus();
  });
  menu.addEventListener('click', (event) => {
    if (event.target instanceof Element && event.target.closest('button[data-closes]')) menu.hidePopover();
  });
  menu.addEventListener('keydown', (event) => {
    const step = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    const stops = [...menu.querySelectorAll('button')].filter((each) => each.checkVisibility());
    const at = stops.findIndex((stop) => stop.matches(':focus'));
    if (!step || at < 0) return;
    event.preventDefault();
    stops[(at + step + stops.length) % stops.length].focus();
  });
  button.after(menu);
  return menu;
}
