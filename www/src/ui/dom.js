/**
 * Creates and binds elements. Text becomes text nodes and styles are set through the CSS object model, as the page's
 * strict content security policy requires.
 */

import { effect } from '@preact/signals-core';
import { segmentsOf } from './segments.js';

/** @import { Children, Given, Props, SvgProps } from './types.js' */

/** Functions to call when a node is disposed of. @type {WeakMap<Node, (() => void)[]>} */
const endings = new WeakMap();

/**
 * Calls `end` once {@link fill} or {@link release} removes the node.
 * @param {Node} node
 * @param {() => void} end
 */
export function endsWith(node, end) {
  const ends = endings.get(node);
  if (ends) ends.push(end);
  else endings.set(node, [end]);
}

/**
 * Runs `act` now and after every change of the signals that it reads, until the node is disposed of.
 * @param {Node} node
 * @param {() => void} act
 */
export const live = (node, act) => endsWith(node, effect(act));

/** Disposes of a node and all within it. @param {Node} node */
export function release(node) {
  for (const end of endings.get(node) ?? []) end();
  endings.delete(node);
  for (const child of node.childNodes) release(child);
}

/**
 * Creates an HTML element.
 *
 * In `props`, `on` holds event listeners, `data` data attributes, `style` CSS properties and `prop` properties of the
 * object. All others are attributes: `true` gives an empty attribute; `false`, `null` and `undefined` give none. A
 * function in place of a value or a child is called again after every change of the signals that it reads, until the
 * element is disposed of.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Props<HTMLElementTagNameMap[K]> | null} [props]
 * @param {...Children} children
 */
export const h = (tag, props, ...children) => equip(document.createElement(tag), props ?? {}, children);

/**
 * Creates an SVG element in the same way.
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} tag
 * @param {SvgProps<SVGElementTagNameMap[K]>} props
 * @param {...Children} children
 */
export const s = (tag, props, ...children) =>
  equip(document.createElementNS('http://www.w3.org/2000/svg', tag), props, children);

/**
 * @template {HTMLElement | SVGElement} E
 * @param {E} element
 * @param {Given<E>} props
 * @param {readonly Children[]} children
 */
function equip(element, { on = {}, data = {}, style = {}, prop = {}, ...attributes }, children) {
  each(element, attributes, (name, value) => setAttribute(element, name, value));
  each(element, data, (name, value) => Object.assign(element.dataset, { [name]: value }));
  each(element, style, (name, value) => element.style.setProperty(name, String(value)));
  append(element, children);
  each(element, prop, (name, value) => Object.assign(element, { [name]: value }));
  for (const [type, listener] of Object.entries(on))
    element.addEventListener(type, /** @type {EventListener} */ (listener));
  return element;
}

/**
 * Sets each of the values; a function is called again after every change of the signals that it reads.
 * @param {Node} node
 * @param {object} values
 * @param {(name: string, value: unknown) => void} set
 */
function each(node, values, set) {
  for (const [name, value] of Object.entries(values)) {
    if (typeof value === 'function') live(node, () => set(name, value()));
    else set(name, value);
  }
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

/** @param {Node} parent @param {Children} child */
function append(parent, child) {
  if (child === null || child === undefined || child === false) return;
  if (typeof child === 'function') follow(parent, child);
  else if (typeof child !== 'object') parent.appendChild(document.createTextNode(String(child)));
  else if (child instanceof Node) parent.appendChild(child);
  else for (const one of child) append(parent, one);
}

/**
 * Appends what `read` returns, and replaces it after every change. A text keeps its node, of which only the data
 * changes.
 * @param {Node} parent
 * @param {() => Children} read
 */
function follow(parent, read) {
  const text = document.createTextNode('');
  parent.appendChild(text);
  /** @type {ChildNode[]} */
  let shown = [];
  live(text, () => {
    const content = read();
    const isText = typeof content === 'string' || typeof content === 'number';
    const next = document.createDocumentFragment();
    append(next, isText ? null : content);
    for (const node of shown) {
      node.remove();
      release(node);
    }
    shown = [...next.childNodes];
    text.before(next);
    if (text.data !== String(isText ? content : '')) text.data = String(isText ? content : '');
  });
}

/**
 * Replaces the children of `parent`, and disposes of the old ones.
 * @param {Element} parent
 * @param {...Children} children
 */
export function fill(parent, ...children) {
  const old = [...parent.childNodes];
  parent.replaceChildren();
  append(parent, children);
  for (const node of old) if (!parent.contains(node)) release(node);
}

/** Returns the element with this id from the page's markup. @param {string} id */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/**
 * Returns the first element within `root` that a selector finds.
 * @overload @param {ParentNode} root @param {string} selector @returns {HTMLElement}
 */
/**
 * @template {typeof HTMLElement} T
 * @overload @param {ParentNode} root @param {string} selector @param {T} kind @returns {InstanceType<T>}
 */
/** @param {ParentNode} root @param {string} selector @param {typeof HTMLElement} [kind] */
export function query(root, selector, kind = HTMLElement) {
  const element = root.querySelector(selector);
  if (!(element instanceof kind)) throw new Error(`the page has no ${kind.name} ${selector}`);
  return element;
}

/** Returns all elements within `root` that a selector finds. @param {ParentNode} root @param {string} selector */
export const queryAll = (root, selector) =>
  [...root.querySelectorAll(selector)].filter((element) => element instanceof HTMLElement);

/** Longest time between the two presses of a double click. */
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

/** Whether the last input came from the keyboard, modifiers aside. */
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

/** Shows a message, with the text between backticks as code. @param {string} message */
export const marked = (message) => segmentsOf(message).map(({ text, code }) => (code ? h('code', null, text) : text));
