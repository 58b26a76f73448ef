/**
 * Number boxes: text fields for a number in the language of formulas, such as `pi/2`. Assistive technology sees native
 * number boxes.
 */
import { h } from './dom.js';

/**
 * Creates a number box.
 * @param {{ name: string, class?: string, id?: string, value?: string, placeholder?: string }} options
 */
export const numberBox = ({ name, ...options }) =>
  h('input', {
    type: 'text',
    role: 'spinbutton',
    class: 'box',
    inputmode: 'decimal',
    autocomplete: 'off',
    spellcheck: 'false',
    'aria-label': name,
    ...options,
  });

/** Shows a number in its box. @param {HTMLInputElement} box @param {string} text */
export function showNumber(box, text) {
  box.value = text;
  box.setAttribute('aria-valuenow', text);
}
