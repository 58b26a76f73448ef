import { describe, expect, it } from 'vitest';
import { changeBetween, describeFault, excerptOf } from '../../../src/ui/field/fault.js';
import { segmentsOf } from '../../../src/ui/segments.js';

/** @import { FieldFault } from '../../../src/engine/types.js' */

/** @type {FieldFault} */
const fault = {
  kind: 'unknown_name',
  message: 'Unknown name foo.',
  start: 4,
  end: 7,
  suggestion: null,
  choices: [],
  mended: null,
  name: 'foo',
  excess: null,
};

describe('a fault in a formula', () => {
  it('is a hint, not an error, where nothing is typed', () => {
    expect(describeFault('', null)?.tone).toBe('hint');
    expect(describeFault(' \n', { ...fault, name: null })?.tone).toBe('hint');
  });

  it('is nothing where the formula is good', () => {
    expect(describeFault('x^2', null)).toBeNull();
  });

  it('marks its place and offers a slider for the unknown name', () => {
    const view = describeFault('x + foo = 1', fault);
    expect(view?.excerpt).toEqual({ before: 'x + ', marked: 'foo', after: ' = 1' });
    expect(view?.repairs).toEqual([{ label: 'Add slider foo', declare: 'foo' }]);
  });

  it('offers each reading of a formula that has several', () => {
    const view = describeFault('x/2y = z', { ...fault, start: 2, end: 4, name: null, choices: ['(2 y)', '2*y'] });
    expect(view?.repairs.map(({ label, replace }) => [label, replace?.text])).toEqual([
      ['Change to (2 y)', '(2 y)'],
      ['Change to 2*y', '2*y'],
    ]);
  });

  it('offers a suggestion first, as a change of the marked place', () => {
    const view = describeFault('x + foo = 1', { ...fault, suggestion: 'floor' });
    expect(view?.repairs[0]).toEqual({ label: 'Change to floor', replace: { start: 4, end: 7, text: 'floor' } });
  });

  it('offers one press for every place of a kind, as the shortest change of the text', () => {
    const mended = { text: 'x^2 + y^2 = 1', places: 2 };
    const view = describeFault('x2 + y2 = 1', { ...fault, start: 0, end: 2, suggestion: 'x^2', mended });
    expect(view?.repairs[0]).toEqual({
      label: 'Change to x^2, in all 2 places',
      replace: { start: 1, end: 6, text: '^2 + y^' },
    });
    expect(changeBetween('aXa', 'aa')).toEqual({ start: 1, end: 2, text: '' });
    expect(changeBetween('aa', 'aaa')).toEqual({ start: 2, end: 2, text: 'a' });
  });

  it('offers another way to write the whole formula in one press', () => {
    const text = 'r = 2cos(3θ)';
    const mended = 'hypot(x, y) = 2cos(3 atan2(y, x))';
    const view = describeFault(text, { ...fault, start: 0, end: text.length, name: null, suggestion: mended });
    expect(view?.repairs).toEqual([
      { label: `Write as ${mended}`, replace: { start: 0, end: text.length, text: mended } },
    ]);
  });

  it('asks for the surface that a text names, whatever else is wrong with it', () => {
    const torus = { id: 'torus', name: 'Torus' };
    const view = describeFault('the torus 2', fault, [torus]);
    expect(view).toMatchObject({ tone: 'hint', message: 'Did you mean the Torus?' });
    expect(view?.repairs).toEqual([{ label: 'Show the Torus', surface: 'torus' }]);
    const knots = describeFault('knot', null, [torus, { id: 'a', name: 'Knot' }, { id: 'b', name: 'Links' }]);
    expect(knots?.message).toBe('Did you mean the Torus, the Knot or the Links?');
  });

  it('says insert where something is missing and remove where something is too much', () => {
    expect(describeFault('(x', { ...fault, start: 2, end: 2, name: null, suggestion: ')' })?.repairs[0].label).toBe(
      'Insert )',
    );
    expect(describeFault('x ?', { ...fault, start: 2, end: 3, name: null, suggestion: '' })?.repairs[0].label).toBe(
      'Remove ?',
    );
    expect(
      describeFault('sin', { ...fault, start: 0, end: 3, name: null, suggestion: 'sin(…)' })?.repairs[0].replace?.text,
    ).toBe('sin()');
  });

  it('shows what stands between backticks as code', () => {
    expect(segmentsOf('No `foo` here')).toEqual([
      { text: 'No ', code: false },
      { text: 'foo', code: true },
      { text: ' here', code: false },
    ]);
    expect(segmentsOf('A ` alone')).toEqual([{ text: 'A ` alone', code: false }]);
  });

  it('survives offsets beyond the text, as they come from an answer to an older text', () => {
    const view = describeFault('x', { ...fault, start: 40, end: 50 });
    expect(view?.excerpt).toEqual({ before: 'x', marked: '', after: '' });
  });

  it('shortens long formulas on both sides of the place', () => {
    const text = `${'x+'.repeat(100)}?${'+y'.repeat(100)}`;
    const { before, marked, after } = excerptOf(text, 200, 201);
    expect(marked).toBe('?');
    expect(before.startsWith('…') && after.endsWith('…')).toBe(true);
    expect(before.length + after.length).toBeLessThan(60);
    expect(excerptOf('y'.repeat(5000), 0, 5000).marked.length).toBeLessThan(60);
  });
});
