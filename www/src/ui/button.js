/** The buttons of the page. */
import { h } from './dom.js';
import { explain } from './explain.js';
import { icon as draw } from './icons.js';

/** @import { ButtonProps, Children, Explanation, Side } from './types.js' */

/**
 * Creates a button with the class `button` and the classes in `class`, and a text or only an icon.
 * @param {ButtonProps} props
 * @param {...Children} children
 */
export function button({ press, icon, off, class: look = icon ? 'plain square' : '', ...props }, ...children) {
  return h(
    'button',
    {
      type: 'button',
      class: look instanceof Function ? () => `button ${look()}` : `button ${look}`,
      'aria-disabled': off && (() => String(off())),
      on: {
        click: () => {
          if (!off?.()) press?.();
        },
      },
      ...props,
    },
    icon && (icon instanceof Function ? () => draw(icon()) : draw(icon)),
    children,
  );
}

/**
 * Creates the name of a figure, which a press explains.
 * @param {() => Explanation} read
 * @param {{ side?: Side }} options
 * @param {...Children} words
 */
export const term = (read, options, ...words) =>
  explain(h('button', { type: 'button', class: 'term' }, words), read, { ...options, tap: true });
