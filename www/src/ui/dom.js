/**
 * Creates and binds elements. Text becomes text nodes and styles are set through the CSS object model, as the page's
 * strict content security policy requires.
 */
import { effect } from '@preact/signals-core';

/** @typedef {Node | string | number | null | undefined | false} Child */
/** @typedef {{ [name: string]: any }} Props */

/**
 * Creates an element.
 *
 * In `props`, `on` holds event listeners, `data` the data attributes and `prop` the properties of the object. All
 * others are attributes: `true` gives an empty attribute; `false`, `null` and `undefined` give none.
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
 * Sets an attribute, or removes it if the value is `false`, `null` or `undefined`.
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
 * Replaces the children of `parent`.
 * @param {Element} parent
 * @param {...(Child | Child[])} children
 */
export function fill(parent, ...children) {
  parent.replaceChildren();
  append(parent, children);
}

/**
 * Keeps the text of `element` equal to `read()`. The node is only changed when the text changes.
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

/** Returns the element with this id from the page's markup. @param {string} id @returns {HTMLElement} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/** Time in which a second press counts as part of a double click. */
const DOUBLE_CLICK_MS = 500;

/** Wraps `act` so that a double click calls it once. @param {() => void} act */
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
/** Returns an id that no other element has. @param {string} stem */
export function uniqueId(stem) {
  last += 1;
  return `${stem}-${last}`;
}

/**
 * Collects the cleanup functions of a part of the page, to be called when that part is replaced.
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

/** Whether the last input was a key other than a modifier. */
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

/** Returns whether the user prefers reduced motion. */
export const reducedMotion = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
