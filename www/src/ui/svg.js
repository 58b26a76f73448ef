/** Creates elements of drawings and of charts. */
import { setAttribute } from './dom.js';

/**
 * @param {string} tag
 * @param {{ [name: string]: unknown }} attributes
 * @param {...(Node | string | null)} children
 */
export function s(tag, attributes, ...children) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) setAttribute(element, name, value);
  element.append(...children.filter((child) => child !== null));
  return element;
}
