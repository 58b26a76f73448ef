import { describe, expect, it } from 'vitest';
import { parseMath, piecesOfMath } from '../../src/ui/mathml.js';

/** @param {import('../../src/ui/mathml.js').MathNode | string} node @returns {string} */
const write = (node) =>
  typeof node === 'string'
    ? node
    : `${node.name}${node.attributes.map(([k, v]) => `[${k}=${v}]`).join('')}(${node.children.map(write).join(' ')})`;

describe('MathML', () => {
  it('is read into a tree', () => {
    const source =
      '<math display="block"><mfrac><msup><mi>x</mi><mn>2</mn></msup><mi>a</mi></mfrac><mo>=</mo><mn>1</mn></math>';
    expect(write(parseMath(source))).toBe('(math[display=block](mfrac(msup(mi(x) mn(2)) mi(a)) mo(=) mn(1)))');
  });

  it('keeps the text of unknown elements and drops the elements and their attributes', () => {
    const source =
      '<math><mi onclick="steal()">x</mi><script>alert(1)</script><img src=x onerror=alert(1)><a href="javascript:1">y</a></math>';
    const written = write(parseMath(source));
    expect(written).not.toMatch(/(script|img|a)(\[[^\]]*\])*\(|onclick|href/);
    expect(written).toContain('mi(x)');
  });

  it('decodes character references as text', () => {
    expect(write(parseMath('<math><mo>&lt;</mo><mi>&#x3c0;</mi><mtext>&lt;img&gt;</mtext></math>'))).toBe(
      '(math(mo(<) mi(π) mtext(<img>)))',
    );
  });

  it('survives what is not closed', () => {
    expect(write(parseMath('<math><mrow><mi>x'))).toBe('(math(mrow(mi(x))))');
    expect(write(parseMath('</math></math>x'))).toBe('(x)');
    expect(write(parseMath('<<<'))).toBe('()');
  });

  it('is taken apart at sums and products outside brackets, nowhere else', () => {
    const source =
      '<math><mrow><mrow><mi>a</mi><mo>+</mo><mrow><mo>(</mo><mrow><mi>b</mi><mo>−</mo><mi>c</mi></mrow><mo>)</mo></mrow><mo>\u2062</mo><mfrac><mrow><mi>x</mi><mo>+</mo><mi>y</mi></mrow><mn>2</mn></mfrac></mrow><mo>=</mo><mn>1</mn></mrow></math>';
    const math = parseMath(source).children[0];
    if (typeof math === 'string') throw new Error('no element');
    expect(piecesOfMath(math).map((piece) => piece.map(write).join(' '))).toEqual([
      'mi(a)',
      'mo[form=infix](+) mrow(mo(() mrow(mi(b) mo(−) mi(c)) mo()))',
      'mfrac(mrow(mi(x) mo(+) mi(y)) mn(2))',
      'mo[form=infix](=) mn(1)',
    ]);
  });
});
