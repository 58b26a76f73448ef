/**
 * Creates and binds elements. Text becomes text nodes and styles are set through the CSS object model, as the page's
 * strict content security policy requires.
 */
import { effect } from '@preact/signals-core';

/** @typedef {Node | string | number | null | undefined | false} Child */
/**
 * What an element may be given: itself, or a function of signals whose text is kept up to date.
 * @typedef {Child | (() => Child)} Given
 */
/** What an attribute may be. @typedef {string | number | boolean | null | undefined} Attribute */
/**
 * @template {HTMLElement} [E=HTMLElement]
 * @typedef {{ on?: { [K in keyof HTMLElementEventMap]?: (event: HTMLElementEventMap[K]) => void }, prop?: Partial<E>,
 *   data?: Record<string, Attribute | (() => Attribute)> } & Record<string, unknown>} Props
 */

/** What ends with a node. @type {WeakMap<Node, (() => void)[]>} */
const endings = new WeakMap();

/**
 * Has `end` called once the node is taken out of the page by {@link fill} or {@link release}.
 * @param {Node} node
 * @param {() => void} end
 */
export function endsWith(node, end) {
  const ends = endings.get(node);
  if (ends) ends.push(end);
  else endings.set(node, [end]);
}

/**
 * Runs `act` now and after every change of the signals that it reads, as long as the node lasts.
 * @param {Node} node
 * @param {() => void} act
 */
export const live = (node, act) => endsWith(node, effect(act));

/** Ends what belongs to a node and to all within it. @param {Node} node */
export function release(node) {
  for (const end of endings.get(node) ?? []) end();
  endings.delete(node);
  for (const child of node.childNodes) release(child);
}

/**
 * Creates an element.
 *
 * In `props`, `on` holds event listeners, `data` the data attributes and `prop` the properties of the object. All
 * others are attributes: `true` gives an empty attribute; `false`, `null` and `undefined` give none. A function in the
 * place of an attribute, a data attribute or a child is read anew after every change of the signals that it reads, as
 * long as the element lasts.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Props<HTMLElementTagNameMap[K]> | null} [props]
 * @param {...(Given | Given[])} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, props, ...children) {
  const element = document.createElement(tag);
  const set = (/** @type {unknown} */ value, /** @type {(value: any) => void} */ act) => {
    if (typeof value === 'function') live(element, () => act(value()));
    else act(value);
  };
  const { on = {}, data = {}, prop, ...attributes } = props ?? {};
  for (const [name, value] of Object.entries(attributes)) set(value, (now) => setAttribute(element, name, now));
  for (const [key, value] of Object.entries(data)) set(value, (now) => Object.assign(element.dataset, { [key]: now }));
  Object.assign(element, prop);
  for (const [type, listener] of Object.entries(on))
    element.addEventListener(type, /** @type {EventListener} */ (listener));
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
 * @param {(Given | Given[])[]} children
 */
function append(parent, children) {
  for (const child of children.flat()) {
    if (child === null || child === undefined || child === false) continue;
    if (typeof child === 'function') parent.appendChild(textOf(child));
    else parent.appendChild(child instanceof Node ? child : document.createTextNode(String(child)));
  }
}

/**
 * Returns a text that is kept equal to what `read` returns. The node is only changed when the text changes.
 * @param {() => Child} read
 */
function textOf(read) {
  const node = document.createTextNode('');
  live(node, () => {
    const text = String(read() ?? '');
    if (node.data !== text) node.data = text;
  });
  return node;
}

/**
 * Replaces the children of `parent`, and ends what belongs to those that go.
 * @param {Element} parent
 * @param {...(Given | Given[])} children
 */
export function fill(parent, ...children) {
  const old = [...parent.childNodes];
  parent.replaceChildren();
  append(parent, children);
  for (const node of old) if (!parent.contains(node)) release(node);
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
