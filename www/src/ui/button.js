/** The page's button. */
import { h } from './dom.js';
import { icon as draw } from './icons.js';

/** @import { ButtonProps, Children } from './types.js' */

/**
 * Creates a button of the class `button` and those of `class`, with a text or with an icon alone.
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
