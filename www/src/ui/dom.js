/**
 * Building and binding elements. Text always becomes text nodes, styles are set through the CSS object model, so
 * nothing here needs more than the strict content security policy of the page.
 */
import { effect } from '@preact/signals-core';

/** @typedef {Node | string | number | null | undefined | false} Child */
/** @typedef {{ [name: string]: any }} Props */

/**
 * A new element.
 *
 * In `props`, `on` holds event listeners, `data` the data attributes, `prop` properties of the object; the rest are attributes:
 * `true` gives an empty one, `false`, `null` and `undefined` none.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Props | null} [props]
 * @param {...(Child | Child[])} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, props, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props ?? {})) {
    if (name === 'on') {
      for (const [type, listener] of Object.entries(value)) element.addEventListener(type, listener);
    } else if (name === 'data') Object.assign(element.dataset, value);
    else if (name === 'prop') Object.assign(element, value);
    else setAttribute(element, name, value);
  }
  append(element, children);
  return element;
}

/**
 * Sets, or with `false`, `null` and `undefined` removes, an attribute.
 * @param {Element} element
 * @param {string} name
 * @param {unknown} value
 */
export function setAttribute(element, name, value) {
  if (value === false || value === null || value === undefined) element.removeAttribute(name);
  else element.setAttribute(name, value === true ? '' : String(value));
}

/**
 * @param {Node} parent
 * @param {(Child | Child[])[]} children
 */
function append(parent, children) {
  for (const child of children.flat()) {
    if (child === null || child === undefined || child === false) continue;
    parent.appendChild(child instanceof Node ? child : document.createTextNode(String(child)));
  }
}

/**
 * Replaces what `parent` holds.
 * @param {Element} parent
 * @param {...(Child | Child[])} children
 */
export function fill(parent, ...children) {
  parent.replaceChildren();
  append(parent, children);
}

/**
 * Keeps the text of `element` equal to `read()`, and leaves the node alone while the text stays the same.
 * @param {Element} element
 * @param {() => string} read
 * @returns {() => void} ends the binding
 */
export function bindText(element, read) {
  return effect(() => {
    const text = read();
    if (element.textContent !== text) element.textContent = text;
  });
}

/** The one element with this id of the page's own markup. @param {string} id @returns {HTMLElement} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/** A second press so soon after the first is a double click, not a second wish. */
const DOUBLE_CLICK_MS = 500;

/** Does `act` once for a double click. @param {() => void} act */
export function once(act) {
  let last = -Infinity;
  return () => {
    const now = performance.now();
    if (now - last < DOUBLE_CLICK_MS) return;
    last = now;
    act();
  };
}

let last = 0;
/** An id that no other element has. @param {string} stem */
export function uniqueId(stem) {
  last += 1;
  return `${stem}-${last}`;
}

/**
 * Collects what has to be ended when a piece of the page is replaced.
 * @returns {{ add(end: () => void): void, end(): void }}
 */
export function createScope() {
  /** @type {(() => void)[]} */
  let ends = [];
  return {
    add: (end) => void ends.push(end),
    end() {
      for (const end of ends) end();
      ends = [];
    },
  };
}

/** True on a keyboard-driven page: the last input was a key other than a modifier. */
let keyboard = false;
addEventListener(
  'keydown',
  (event) => {
    if (!event.metaKey && !event.ctrlKey && !event.altKey) keyboard = true;
  },
  true,
);
addEventListener(
  'pointerdown',
  () => {
    keyboard = false;
  },
  true,
);
export const usesKeyboard = () => keyboard;

/** Whether the reader asked for less motion. */
export const reducedMotion = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
