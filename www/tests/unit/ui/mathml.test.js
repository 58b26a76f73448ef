import { describe, expect, it } from 'vitest';
import { partsOfMath } from '../../../src/ui/mathml.js';

/** @import { MathNode } from '../../../src/engine/types.js' */

/** @param {'mi' | 'mn' | 'mo'} tag @returns {(text: string) => MathNode} */
const token = (tag) => (text) => ({ tag, text });
const [mi, mn, mo] = [token('mi'), token('mn'), token('mo')];
/** @param {...MathNode} children @returns {MathNode} */
const row = (...children) => ({ tag: 'mrow', children });

/** @param {MathNode} node @returns {string} */
const write = (node) => ('text' in node ? node.text : `${node.tag}(${node.children.map(write).join(' ')})`);
/** @param {MathNode} node */
const parts = (node) => partsOfMath(node).map((part) => part.map(write).join(' '));

describe('MathML', () => {
  it('is taken apart at sums and products outside brackets, nowhere else', () => {
    const bracket = row(mo('('), row(mi('b'), mo('−'), mi('c')), mo(')'));
    /** @type {MathNode} */
    const fraction = { tag: 'mfrac', children: [row(mi('x'), mo('+'), mi('y')), mn('2')] };
    const product = row(row(mi('a'), mo('+'), bracket), mo('\u2062'), fraction);
    expect(parts(row(product, mo('='), mn('1')))).toEqual([
      'a',
      '+ mrow(( mrow(b − c) ))',
      'mfrac(mrow(x + y) 2)',
      '= 1',
    ]);
  });

  it('is taken apart between the arguments of a function, and at the sums in them', () => {
    const args = row(mo('('), row(mi('a'), mo('+'), mi('b')), mo(','), row(mo('−'), mi('c')), mo(')'));
    const max = row(mi('max'), mo('\u2061'), args);
    expect(parts(row(max, mo('='), mn('0')))).toEqual(['max \u2061 ( a', '+ b ,', '− c )', '= 0']);
  });

  it('keeps a sign with what it stands before', () => {
    expect(parts(row(row(mo('−'), mi('x')), mo('='), mn('0')))).toEqual(['− x', '= 0']);
  });
});
