import { describe, expect, test } from 'vitest';
import { FILE_SURFACE, MODEL, MOST_LINE_POINTS } from '../../../src/engine/constants.js';
import { decode, encode, LONGEST_FRAGMENT } from '../../../src/engine/share/codec.js';
import {
  clampSettings,
  defaultState,
  fieldRequest,
  IN_FILE,
  MARKED,
  mergeState,
  namesModel,
  sanitize,
} from '../../../src/engine/share/state.js';
import { description } from './description.js';

/** @import { State } from '../../../src/engine/types.js' */

/** @returns {State} */
const elaborate = () => ({
  v: 1,
  surface: 'torus',
  formula: 'x^2 + y^2 + sin(k z)^2 − 1',
  parameters: { k: 2.5, R: 1.25 },
  declared: [{ name: 'k', label: 'k', value: 1, min: -3, max: 3, step: 0.01 }],
  centres: null,
  bounds: { min: [-1, -2, -3], max: [1, 2, 3] },
  pulls: [],
  lines: [],
  plane: { normal: [0, 0.6, -0.8], offset: 0.25 },
  settings: { radius_share: 0.012, relax_steps: 20 },
  view: {
    colour: 'valence',
    value: 'k_1 + n_x',
    size: 0.8,
    projection: 'orthographic',
    draw: 'mesh',
    creases: false,
    faces: 'flat',
    edges: false,
    marks: false,
    theme: 'dark',
    flow: true,
    body: false,
    box: true,
    axes: true,
    bar: true,
    measured: [17, 4],
    points: false,
    level: 12,
    step: 3,
    camera: { target: [0.5, 0, -0.25], distance: 6.5, yaw: -1.25, pitch: 0.5, fit: false },
  },
});

const inLink = (/** @type {unknown} */ value, kind = 'j') =>
  `#v1.${kind}.${Buffer.from(typeof value === 'string' ? value : JSON.stringify(value)).toString('base64url')}`;

async function deflated(/** @type {string} */ text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  return `#v1.z.${Buffer.from(await new Response(stream).arrayBuffer()).toString('base64url')}`;
}

describe('a link', () => {
  test('brings back the whole state', async () => {
    const state = elaborate();
    const link = await encode(state, description);
    const back = await decode(link, description);
    expect(back.problem).toBe(null);
    expect(back.reset).toEqual([]);
    expect(back.state).toEqual(state);
  });

  test('holds how many points of a model are fitted, as many as there can be', async () => {
    const bunny = { ...defaultState(description), surface: 'bunny', formula: MODEL };
    const back = async (/** @type {State} */ state) =>
      (await decode(await encode(state, description), description)).state;
    expect((await back({ ...bunny, centres: 120 })).centres).toBe(120);
    expect((await back(bunny)).centres).toBe(null);
    const of = (/** @type {object} */ raw) => {
      const { state, reset } = sanitize(raw, description, true);
      return [state.centres, reset];
    };
    // The bunny has 200 points, all of which are fitted by default.
    expect(of({ surface: 'bunny', centres: 200 })).toEqual([null, []]);
    expect(of({ surface: 'bunny', centres: 500 })).toEqual([null, []]);
    expect(of({ surface: 'bunny', centres: 7 })).toEqual([100, []]);
    expect(of({ surface: FILE_SURFACE, centres: 500 })).toEqual([500, []]);
    expect(of({ surface: 'torus', centres: 120 })).toEqual([null, ['number of centres']]);
    expect(of({ surface: 'bunny', centres: 'many' })).toEqual([null, ['number of centres']]);
  });

  test('holds the marked edges of a file, of so many points, and says that without the file they are gone', async () => {
    const line = (/** @type {number} */ points) => Array.from({ length: points }, (_, k) => [k, 0.5, 1 - k]);
    const marked = { surface: FILE_SURFACE, lines: [line(2), line(3)] };
    const of = (/** @type {unknown} */ raw, hasFile = true) => {
      const { state, reset } = sanitize(raw, description, hasFile);
      return [state.lines, reset];
    };
    expect(of(marked)).toEqual([marked.lines, []]);
    const { state } = sanitize(marked, description, true);
    expect((await decode(await encode(state, description), description, true)).state.lines).toEqual(marked.lines);
    expect(fieldRequest(state, description, 'file 1').lines).toEqual(marked.lines);
    expect(of(marked, false)).toEqual([[], [IN_FILE, MARKED]]);
    expect(of({ ...marked, lines: [line(MOST_LINE_POINTS)] })[1]).toEqual([]);
    const wrong = [
      [line(1)],
      [line(MOST_LINE_POINTS), line(2)],
      [[[0, 1]]],
      [7],
      'many',
      [
        [
          [0, 0, 0],
          [1, 0, 'a'],
        ],
      ],
    ];
    for (const lines of wrong) expect(of({ ...marked, lines })).toEqual([[], ['marked edges']]);
    expect(of({ surface: 'bunny', lines: [line(2)] })).toEqual([[], ['marked edges']]);
  });

  test('holds the pulls on a model, and none that would tear it', async () => {
    const pull = { at: [0.1, 0.2, 0.3], by: [0, 0.25, 0], reach: 0.5 };
    const bunny = { ...defaultState(description), surface: 'bunny', formula: MODEL, pulls: [pull, pull] };
    const { state, reset } = await decode(await encode(/** @type {State} */ (bunny), description), description);
    expect([state, reset]).toEqual([bunny, []]);
    const of = (/** @type {object} */ raw) => {
      const { state, reset } = sanitize(raw, description, true);
      return [state.pulls, reset];
    };
    expect(of({ surface: 'bunny', pulls: [pull, { ...pull, reach: 0.4 }] })).toEqual([[], ['pulls']]);
    expect(of({ surface: 'torus', pulls: [pull] })).toEqual([[], ['pulls']]);
    expect(of({ surface: 'bunny', pulls: 'many' })).toEqual([[], ['pulls']]);
    const many = (/** @type {number} */ n) => Array.from({ length: n }, () => pull);
    expect(of({ surface: FILE_SURFACE, pulls: many(32) })).toEqual([many(32), []]);
    expect(of({ surface: FILE_SURFACE, pulls: many(33) })).toEqual([[], ['pulls']]);
  });

  test('holds that a box was enlarged by a press, which the core is not told', async () => {
    /** @type {NonNullable<State['bounds']>} */
    const bounds = { min: [-1, -2, -3], max: [1, 2, 3], enlarged: 'endless' };
    const { state } = await decode(await encode({ ...elaborate(), bounds }, description), description);
    expect(state.bounds).toEqual(bounds);
    expect(fieldRequest(state, description).bounds).toEqual(elaborate().bounds);
    const other = sanitize({ bounds: { ...bounds, enlarged: 'twice' } }, description, true).state;
    expect(other.bounds).toEqual(elaborate().bounds);
  });

  test('of the default state is empty', async () => {
    expect(await encode(defaultState(description), description)).toBe('');
    expect((await decode('', description)).state).toEqual(defaultState(description));
    expect((await decode('#', description)).problem).toBe(null);
  });

  test('deflates a long formula, and brings it back', async () => {
    const state = { ...elaborate(), formula: Array.from({ length: 200 }, (_, k) => `x^2 y z + ${k % 7}`).join(' + ') };
    const link = await encode(state, description);
    expect(link).toMatch(/^#v1\.z\./);
    expect(link.length).toBeLessThan(state.formula.length);
    expect((await decode(link, description)).state).toEqual(state);
  });

  test('is made of characters that survive any messenger', async () => {
    expect(await encode(elaborate(), description)).toMatch(/^#[A-Za-z0-9._-]+$/);
  });

  test('that is damaged, cut off, of the future or far too long changes nothing, and says which', async () => {
    const link = await encode(elaborate(), description);
    const cases = /** @type {const} */ ([
      ['#hello', 'damaged'],
      [link.slice(0, -9), 'damaged'],
      [`${link}*`, 'damaged'],
      [link.replace('v1', 'v99'), 'another version'],
      [`#v1.j.${'A'.repeat(200_000)}`, 'too long'],
      [inLink('{"surface":'), 'damaged'],
      [inLink('\u0000'), 'damaged'],
      ['#v1.z.AAAA', 'damaged'],
      ['#v1.q.AAAA', 'damaged'],
    ]);
    for (const [text, words] of cases) {
      const back = await decode(text, description);
      expect(back.problem, text.slice(0, 60)).toContain(words);
      expect(back.state).toEqual(defaultState(description));
    }
  });

  test('that inflates beyond 64 kB is let go of before it is whole', async () => {
    const bomb = await deflated(`{"formula":"${'x'.repeat(30_000_000)}"}`);
    expect(bomb.length).toBeLessThan(LONGEST_FRAGMENT);
    expect((await decode(bomb, description)).problem).toContain('too much');
  });

  test('carries markup as text only', async () => {
    const formula = '<img src=x onerror=alert(1)>';
    const back = await decode(inLink({ formula }), description);
    expect(back.state.formula).toBe(formula);
    expect(back.reset).toEqual([]);
  });
});

describe('a surface made of points', () => {
  const bunny = { ...defaultState(description), surface: 'bunny', formula: MODEL, settings: { radius_share: 0.02 } };

  test('goes through a link by its name', async () => {
    const link = await encode(bunny, description);
    expect(await decode(link, description)).toEqual({ state: bunny, reset: [], problem: null });
    const clipped = { ...bunny, bounds: elaborate().bounds, view: { ...bunny.view, points: false } };
    expect((await decode(await encode(clipped, description), description)).state).toEqual(clipped);
  });

  test('takes a formula that names the model, and no other', async () => {
    expect(sanitize({ surface: 'bunny', formula: 'x' }, description)).toMatchObject({
      state: { surface: 'bunny', formula: MODEL },
      reset: ['formula'],
    });
    // As older links have it.
    expect(sanitize({ ...bunny, formula: '' }, description)).toEqual({ state: bunny, reset: [] });
    const cut = { ...bunny, formula: 'max(model, z - h)', parameters: { h: 0.2 } };
    expect(sanitize(cut, description)).toEqual({ state: cut, reset: [] });
    expect((await decode(await encode(cut, description), description)).state).toEqual(cut);
  });

  test('keeps its box while a formula names it, and gives way to one that does not', () => {
    const boxed = { ...bunny, bounds: elaborate().bounds };
    const { state } = mergeState(boxed, { formula: 'abs(model) - 0.1' }, description, false);
    expect(state).toEqual({ ...boxed, formula: 'abs(model) - 0.1' });
    expect(mergeState(boxed, { formula: 'x' }, description, false).state).toMatchObject({
      surface: 'ellipsoid',
      formula: 'x',
      bounds: null,
    });
  });

  test.each([
    ['max(model, z)', true],
    ['2model', true],
    ['-model // hollow', true],
    ['z // max(model, z)', false],
    ['z /* model */ # model', false],
    ['max(models, my_model, model2)', false],
    ['max(mode', false],
    ['', false],
  ])('%s names the model: %s', (formula, isNamed) => {
    expect(namesModel(formula)).toBe(isNamed);
  });

  test('from a file is not in the link: the standard surface comes in its place, with settings and colour', async () => {
    const file = {
      ...bunny,
      surface: FILE_SURFACE,
      bounds: elaborate().bounds,
      view: { ...elaborate().view, colour: /** @type {const} */ ('radius') },
    };
    const link = await encode(file, description);
    const { state, reset, problem } = await decode(link, description);
    expect(problem).toBe(null);
    expect(reset).toEqual([IN_FILE]);
    const home = defaultState(description);
    expect(state).toEqual({ ...home, settings: file.settings, view: { ...file.view, camera: home.view.camera } });
    // In the page that still has the file, it is found again.
    expect((await decode(link, description, true)).state).toEqual(file);
  });

  test('is asked of the core by the name of its solved model', () => {
    expect(fieldRequest(bunny, description, 'bunny')).toEqual({ points: 'bunny', surface: 'bunny' });
    expect(fieldRequest({ ...bunny, formula: ' model\n' }, description, 'bunny')).toEqual({
      points: 'bunny',
      surface: 'bunny',
    });
    expect(
      fieldRequest({ ...bunny, formula: 'max(model, z - h)', parameters: { h: 0.2 } }, description, 'bunny'),
    ).toEqual({ points: 'bunny', surface: 'bunny', formula: 'max(model, z - h)', parameters: { h: 0.2 } });
    expect(
      fieldRequest({ ...bunny, surface: FILE_SURFACE, bounds: elaborate().bounds }, description, 'file 3'),
    ).toEqual({ points: 'file 3', surface: 'file', bounds: elaborate().bounds });
  });
});

test('settings of a coarser run stay within their ranges', () => {
  expect(clampSettings(description, { radius_share: 3, relax_steps: 2, size_mode: 'count', unknown: 7 })).toEqual({
    radius_share: 0.1,
    relax_steps: 2,
    size_mode: 'count',
    unknown: 7,
  });
});

describe('a state from anywhere', () => {
  test('is clamped, and what was reset is named', () => {
    const { state, reset } = sanitize(
      {
        surface: 'no such surface',
        formula: 'x'.repeat(5000),
        parameters: { a: Infinity, 'bad name': 1, c: 2, d: 1e9, ...Object.fromEntries([['_b', 1]]) },
        declared: [{ name: 'k', min: 3, max: 1 }, 7, { name: 'm' }],
        bounds: { min: [0, 0, 0], max: [1, 0, 1] },
        plane: { normal: [0, 0, 0], offset: 1 },
        settings: { radius_share: 5, relax_steps: 2.4, size_mode: 'magic', placement: 'faithful', count: 'many' },
        view: {
          colour: 'pink',
          size: 99,
          theme: 'blue',
          box: 'yes',
          measured: [1, 1],
          camera: { distance: Number.NaN },
        },
      },
      description,
    );
    expect(state.surface).toBe('ellipsoid');
    expect(state.formula).toBe(description.surfaces[0].formula);
    expect(state.parameters).toEqual({ c: 2, d: 1e9 });
    expect(state.declared).toEqual([{ name: 'm', label: 'm', value: 1, min: 0, max: 3, step: 0.01 }]);
    expect(state.bounds).toBe(null);
    expect(state.settings).toEqual({ radius_share: 0.1, relax_steps: 2 });
    expect(state.view).toEqual({ ...defaultState(description).view, size: 1.5 });
    for (const name of [
      'surface',
      'formula',
      'parameter a',
      'parameter bad name',
      'parameter _b',
      'a declared parameter',
      'clip box',
      'cutting plane',
      'measured distance',
      'setting radius_share',
      'setting relax_steps',
      'setting size_mode',
      // A setting of older links.
      'setting placement',
      'setting count',
      'colour',
      'disc size',
      'theme',
      'box',
      'camera',
    ]) {
      expect(reset).toContain(name);
    }
    expect(reset).not.toContain('parameter c');
    expect(state.plane).toBe(null);
  });

  test('gets a cutting plane with a unit normal', () => {
    const { state, reset } = sanitize({ plane: { normal: [0, 3, 4], offset: 10 } }, description);
    expect(reset).toEqual([]);
    expect(state.plane).toEqual({ normal: [0, 0.6, 0.8], offset: 2 });
    for (const plane of [7, {}, { normal: [1, 0], offset: 0 }, { normal: [1, 0, 0], offset: '0' }])
      expect(sanitize({ plane }, description).reset).toEqual(['cutting plane']);
  });

  test.each([null, 7, 'text', [], [[]], { view: 3, settings: [], parameters: 'x', declared: {} }])(
    '%j is turned into a valid one',
    (raw) => {
      const { state } = sanitize(raw, description);
      expect(state).toEqual(defaultState(description));
    },
  );

  test('a prototype is not to be had through it', () => {
    const { state } = sanitize(
      JSON.parse('{"parameters":{"__proto__":1,"constructor":2},"settings":{"__proto__":{"a":1}}}'),
      description,
    );
    expect(Object.getPrototypeOf(state.parameters)).toBe(Object.prototype);
    expect(/** @type {any} */ ({}).a).toBe(undefined);
  });
});

test('the core is told the formula only where it differs from the gallery’s', () => {
  const state = defaultState(description);
  expect(fieldRequest(state, description)).toEqual({ surface: 'ellipsoid', parameters: {} });
  expect(fieldRequest(elaborate(), description)).toEqual({
    surface: 'torus',
    formula: 'x^2 + y^2 + sin(k z)^2 − 1',
    parameters: { k: 2.5, R: 1.25 },
    declare: elaborate().declared,
    bounds: elaborate().bounds,
  });
});
