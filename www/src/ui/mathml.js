/** Builds MathML elements from the core's expression tree. */

/** @import { MathNode } from '../engine/types.js' */

const NAMESPACE = 'http://www.w3.org/1998/Math/MathML';

/** @param {string} tag @param {Record<string, string>} attributes @param {(Node | string)[]} children */
function element(tag, attributes, children) {
  const made = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** @param {MathNode} node @returns {Element} */
const build = (node) => element(node.tag, {}, 'text' in node ? [node.text] : node.children.map(build));

/** Returns the formula as one display element. @param {MathNode} node */
export const mathElement = (node) => element('math', { display: 'block' }, [build(node)]);

/** Operators before which a long formula may break into the next line. */
const BREAKS = new Set(['=', '+', '−', '\u2062']);
/** Invisible multiplication. A line may break there, but nothing is shown. */
const INVISIBLE = '\u2062';

/** @param {MathNode} node */
const operatorOf = (node) => (node.tag === 'mo' ? node.text : null);

/** @param {MathNode} node */
const isBreak = (node) => BREAKS.has(operatorOf(node) ?? '');

/**
 * Splits a formula into parts that may go on different lines: at the operators of sums and products outside brackets,
 * and likewise within the arguments of a function.
 * @param {MathNode} node
 * @returns {MathNode[][]}
 */
export function partsOfMath(node) {
  const isArguments = isList(node);
  if (!isArguments && !isOpen(node)) return [[node]];
  /** @type {MathNode[][]} */
  const parts = [[]];
  for (const child of node.children) {
    if (isBreak(child)) {
      parts.push(operatorOf(child) === INVISIBLE ? [] : [child]);
      continue;
    }
    const [first, ...rest] = partsOfMath(child);
    parts.at(-1)?.push(...first);
    parts.push(...rest);
    if (isArguments && operatorOf(child) === ',') parts.push([]);
  }
  return parts.filter((part) => part.length > 0);
}

/**
 * Returns whether a node is a row without brackets.
 * @param {MathNode} node
 * @returns {node is Extract<MathNode, {children: unknown}>}
 */
const isOpen = (node) => node.tag === 'mrow' && (operatorOf(node.children[0]) === null || isBreak(node.children[0]));

/**
 * Returns whether a node is a bracketed list of several arguments.
 * @param {MathNode} node
 * @returns {node is Extract<MathNode, {children: unknown}>}
 */
const isList = (node) =>
  node.tag === 'mrow' &&
  operatorOf(node.children[0]) === '(' &&
  node.children.some((child) => operatorOf(child) === ',');

/**
 * Returns the lines of a formula, which are rows of a table: its definitions and its surface.
 * @param {MathNode} node
 * @returns {MathNode[]}
 */
const linesOf = (node) =>
  node.tag === 'mtable' ? node.children.flatMap((row) => ('children' in row ? cellsOf(row.children) : [])) : [node];

/** @param {MathNode[]} cells */
const cellsOf = (cells) => cells.flatMap((cell) => ('children' in cell ? cell.children : [cell]));

/** Returns each line of a formula as elements between which it may break. @param {MathNode} node */
export const mathLines = (node) => linesOf(node).map(mathParts);

/** Returns the formula as elements between which a line may break. @param {MathNode} node */
export const mathParts = (node) =>
  partsOfMath(node).map((part) => {
    const children = part.map(build);
    // At the start of a part, an operator would be treated as a sign and lose its spaces.
    if (isBreak(part[0])) children[0].setAttribute('form', 'infix');
    return element('math', { displaystyle: 'true' }, [element('mrow', {}, children)]);
  });
