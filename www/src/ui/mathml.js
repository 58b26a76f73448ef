/**
 * MathML text to elements: reads only the elements a formula needs, each by name, and drops everything else, so a string
 * never becomes markup of another kind.
 */

const NAMESPACE = 'http://www.w3.org/1998/Math/MathML';
const ELEMENTS = new Set([
  'math',
  'mrow',
  'mi',
  'mn',
  'mo',
  'ms',
  'mtext',
  'mspace',
  'msup',
  'msub',
  'msubsup',
  'mfrac',
  'msqrt',
  'mroot',
  'mover',
  'munder',
  'mtable',
  'mtr',
  'mtd',
  'mpadded',
  'mphantom',
  'mstyle',
  'merror',
]);
const ATTRIBUTES = new Set([
  'display',
  'stretchy',
  'fence',
  'form',
  'lspace',
  'rspace',
  'separator',
  'mathvariant',
  'displaystyle',
  'linethickness',
  'width',
  'class',
]);
const ENTITIES = /** @type {Record<string, string>} */ ({
  amp: '&',
  lt: '<',
  gt: '>',
  quot: '"',
  apos: "'",
  nbsp: '\u00a0',
});

/** @param {string} text */
function decode(text) {
  return text.replace(/&(#x[\da-f]+|#\d+|\w+);/gi, (whole, name) => {
    if (name[0] !== '#') return ENTITIES[name] ?? whole;
    const code = name[1] === 'x' || name[1] === 'X' ? parseInt(name.slice(2), 16) : parseInt(name.slice(1), 10);
    return code > 0 && code <= 0x10ffff ? String.fromCodePoint(code) : '';
  });
}

/**
 * @typedef {{ name: string, attributes: [string, string][], children: (MathNode | string)[] }} MathNode
 */

/**
 * The tree of a MathML string; unknown elements are replaced by what they hold.
 * @param {string} source
 * @returns {MathNode}
 */
export function parseMath(source) {
  /** @type {MathNode} */
  const root = { name: '', attributes: [], children: [] };
  /** @type {(MathNode | null)[]} */
  const stack = [root];
  const tokens = /<(\/?)([a-zA-Z][\w-]*)((?:\s+[\w:-]+\s*=\s*(?:"[^"]*"|'[^']*'))*)\s*(\/?)>|([^<]+)|</g;
  for (const [, slash, name, attributes, closed, text] of source.matchAll(tokens)) {
    const parent = /** @type {MathNode} */ (stack.findLast((node) => node !== null));
    if (text !== undefined) {
      const written = decode(text);
      if (written.trim()) parent.children.push(written.trim());
      continue;
    }
    if (name === undefined) continue;
    if (slash) {
      if (stack.length > 1) stack.pop();
      continue;
    }
    /** @type {MathNode | null} */
    let node = null;
    if (ELEMENTS.has(name)) {
      node = { name, attributes: [], children: [] };
      for (const [, key, , double, single] of (attributes ?? '').matchAll(/([\w:-]+)\s*=\s*("([^"]*)"|'([^']*)')/g)) {
        if (ATTRIBUTES.has(key)) node.attributes.push([key, decode(double ?? single ?? '')]);
      }
      parent.children.push(node);
    }
    if (!closed) stack.push(node);
  }
  return root;
}

/** @param {MathNode | string} node @returns {Node} */
function build(node) {
  if (typeof node === 'string') return document.createTextNode(node);
  const element = document.createElementNS(NAMESPACE, node.name);
  for (const [name, value] of node.attributes) element.setAttribute(name, value);
  for (const child of node.children) element.append(build(child));
  return element;
}

/**
 * The formula as elements, or null where the string holds none.
 * @param {string} source
 */
export function mathElement(source) {
  const root = parseMath(source);
  const math = root.children.find((child) => typeof child !== 'string' && child.name === 'math');
  return math ? /** @type {Element} */ (build(math)) : null;
}

/** Where a long formula may go on in the next line: before these. */
const BREAKS = new Set(['=', '+', '−', '-', '<', '>', '≤', '≥', '\u2062']);
/** Invisible multiplication: breaks, but shows nothing. */
const INVISIBLE = '\u2062';

/** @param {MathNode | string} node */
const operatorOf = (node) =>
  typeof node !== 'string' && node.name === 'mo' && typeof node.children[0] === 'string' ? node.children[0] : null;

/**
 * The formula in pieces that may stand in different lines: sums and products outside brackets are taken apart.
 * @param {MathNode} node a `math` or `mrow` element
 * @returns {(MathNode | string)[][]}
 */
export function piecesOfMath(node) {
  /** @type {(MathNode | string)[][]} */
  const pieces = [[]];
  for (const child of node.children) {
    const operator = operatorOf(child);
    if (operator !== null && BREAKS.has(operator)) {
      // At the head of a piece it would be taken for a sign and lose its spaces.
      pieces.push(
        operator === INVISIBLE || typeof child === 'string'
          ? []
          : [{ ...child, attributes: [...child.attributes, ['form', 'infix']] }],
      );
      continue;
    }
    const parts = typeof child !== 'string' && isOpen(child) ? piecesOfMath(child) : [[child]];
    pieces.at(-1)?.push(...parts[0]);
    pieces.push(...parts.slice(1));
  }
  return pieces.filter((piece) => piece.length > 0);
}

/** A row that is not in brackets. @param {MathNode} node */
function isOpen({ name, children }) {
  const operator = children.length > 0 ? operatorOf(children[0]) : null;
  return name === 'mrow' && (operator === null || BREAKS.has(operator));
}

/**
 * The formula as several elements, between which a line may end.
 * @param {string} source
 */
export function mathPieces(source) {
  const math = parseMath(source).children.find((child) => typeof child !== 'string' && child.name === 'math');
  if (!math || typeof math === 'string') return [];
  return piecesOfMath(math).map((children) =>
    build({
      name: 'math',
      attributes: [['displaystyle', 'true']],
      children: [{ name: 'mrow', attributes: [], children }],
    }),
  );
}
