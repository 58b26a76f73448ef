/** Values by a formula: how they come to the page, and the colours and settings that formulas give. */
import { expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { compared, valued } from '../../../src/engine/sampling/joining.js';
import { csv, ply } from '../../../src/engine/share/exports.js';
import { lastingSettings, validSetting } from '../../../src/engine/share/state.js';
import { homeView, validView } from '../../../src/engine/share/view.js';
import { coloursOf, legendOf, rangeOf } from '../../../src/engine/view/colouring.js';
import { PALETTES } from '../../../src/engine/view/palettes.js';
import { description } from './description.js';

/** @param {number[]} values */
function columnsOf(values) {
  const columns = new Columns();
  columns.count = values.length;
  columns.writeValue(Float32Array.from(values));
  return columns;
}

/** An environment of a worker in which nothing else happens, or a job replaces the particles after some steps. */
const env = (steps = Number.POSITIVE_INFINITY) => {
  let made = 0;
  return {
    nowMs: () => 0,
    pause: async () => {},
    post: () => {},
    interrupt: () => {
      made += 1;
      return made > steps ? /** @type {const} */ ('replace') : null;
    },
  };
};

test('a value is made in slices, refused with its mistake, and given up with its particles', async () => {
  let left = 3;
  const core = /** @type {any} */ ({
    add_value: (/** @type {string} */ name, /** @type {string} */ formula) => {
      expect(name).toBe('value');
      left -= 1;
      if (left > 0) return undefined;
      return formula === 'q' ? { message: 'Value: A particle has no `q`' } : null;
    },
    added_value: () => Float32Array.of(1, 2),
    compare: () => undefined,
  });
  expect(await valued(core, 'z', env())).toEqual({ values: Float32Array.of(1, 2), fault: null });
  expect(await valued(core, 'q', env())).toEqual({
    values: new Float32Array(0),
    fault: 'Value: A particle has no `q`',
  });
  left = 9;
  expect(await valued(core, 'z', env(2))).toBe(null);
  expect(await compared(core, env(2))).toBe(null);
  expect(await compared({ compare: () => null }, env())).toEqual({ change: null });
});

test('values of one sign have a ramp between their ends, of both signs one around 0, and NaN the plain colour', () => {
  const { sequential, diverging, plain } = PALETTES.light;
  const one = columnsOf([2, 3, 4, Number.NaN]);
  expect(rangeOf('value', one)).toEqual([2, 4]);
  expect([...coloursOf('value', 'light', one, 0, 4)]).toEqual([
    sequential[0],
    sequential[Math.round(0.5 * (sequential.length - 1))],
    sequential.at(-1),
    plain,
  ]);
  expect(legendOf('value', 'light', one)).toMatchObject({ kind: 'sequential', range: [2, 4], pending: false });
  const both = columnsOf([-1, 0, 1]);
  expect(rangeOf('value', both)?.map(Math.abs)).toEqual([1, 1]);
  expect(coloursOf('value', 'light', both, 2, 3)[0]).toBe(diverging.at(-1));
  expect(legendOf('value', 'light', both)).toMatchObject({ kind: 'diverging', mark: 0 });
  // Before they are there, and where none is a number, the particles are plain.
  both.forget();
  expect(legendOf('value', 'light', both).pending).toBe(true);
  expect(rangeOf('value', columnsOf([Number.NaN]))).toBe(null);
  both.writeValue(Float32Array.of(1));
  expect(both.value).toBe(null);
});

test('the colours of a surface are shown as they are, or as a number on a ramp', () => {
  const { plain, sequential } = PALETTES.light;
  const columns = columnsOf([0, 0, 0]);
  expect(legendOf('own', 'light', columns).pending).toBe(true);
  const third = Float32Array.of(0, 1, Number.NaN);
  columns.writeOwn({ red: Float32Array.of(1, 0.5, 1), green: Float32Array.of(0, 0.5, 0), blue: third });
  expect([...coloursOf('own', 'light', columns, 0, 3)]).toEqual([0xff0000ff, 0xffff8080, plain]);
  expect(legendOf('own', 'light', columns)).toMatchObject({ title: 'Its own colours', pending: false });
  columns.writeOwn({ colour: Float32Array.of(1, 2, 3), short: Float32Array.of(1) });
  expect(Object.keys(columns.own ?? {})).toEqual(['colour']);
  expect(rangeOf('own', columns)).toEqual([1, 3]);
  expect(coloursOf('own', 'light', columns, 2, 3)[0]).toBe(sequential.at(-1));
  expect(legendOf('own', 'light', columns)).toMatchObject({ title: 'Its own colour', kind: 'sequential' });
  columns.writeOwn({});
  expect(legendOf('own', 'light', columns)).toMatchObject({
    title: 'This surface has no colours of its own',
    pending: false,
  });
});

test('PLY has the parts of a colour in eight bits', async () => {
  const values = { red: Float32Array.of(0.2), green: Float32Array.of(1.5), blue: Float32Array.of(0) };
  const columns = Object.assign(Object.create(columnsOf([0.5])), { values });
  const all = /** @type {any} */ (Object.keys(values).map((name) => ({ name, kind: 'float' })));
  const file = new Uint8Array(await ply(columns, all, null).arrayBuffer());
  expect(new TextDecoder().decode(file)).toContain('property uchar green');
  expect([...file.slice(-3)]).toEqual([51, 255, 0]);
});

test('files have the values as a column', async () => {
  const columns = Object.assign(Object.create(columnsOf([0.5])), { values: { value: Float32Array.of(0.5) } });
  columns.positions = Float32Array.of(1, 2, 3);
  const all = /** @type {any} */ ([
    { name: 'x', kind: 'coordinate' },
    { name: 'value', kind: 'float' },
  ]);
  expect(await csv(columns, all).text()).toBe('x,value\n1,0.5\n');
});

test('the formula of the colours is a part of the view, and that of the spacing a setting of one surface', () => {
  /** @type {string[]} */
  const reset = [];
  expect(validView({ value: 'k_1' }, homeView(), reset).value).toBe('k_1');
  expect(validView({ value: ' ' }, homeView(), reset).value).toBe('k_1 k_2');
  expect(reset).toEqual(['formula of the colours']);
  const spacing = { ...description.settings[0], name: 'spacing', kind: /** @type {const} */ ('text'), default: '' };
  const about = { ...description, settings: [...description.settings, spacing] };
  expect([' 0.1 + z ', '', 3, 'z'.repeat(5000)].map((v) => validSetting(about, 'spacing', v))).toEqual([
    '0.1 + z',
    '',
    undefined,
    undefined,
  ]);
  expect(lastingSettings(about, { spacing: '0.1', count: 200 })).toEqual({ count: 200 });
});
