/** The parts of the lesson that need no browser. */
import { expect, test } from 'vitest';
import { readAddress, stopFor, writeAddress } from '../../../src/learn/address.js';
import { Stops } from '../../../src/learn/answers.js';
import { knobDifference, SEED, seedAt, turned, USUAL } from '../../../src/learn/knobs.js';
import { asFineEverywhere, nearestDistances, ringsOf, sharpestBend } from '../../../src/learn/measure.js';
import { cellOf } from '../../../src/learn/patch.js';
import { bestOf, rowOf, scoreOf, verdictOf } from '../../../src/learn/score.js';
import { subjectOf } from '../../../src/learn/surface.js';
import { packTask, readWork, tableOfAll, unpackTask } from '../../../src/learn/task.js';
import { packCarried, packed, unpackCarried, unpacked } from '../../../src/ui/surface-link.js';

/** @import { Control } from '../../../src/learn/types.js' */

const SURFACE = {
  formula: 'x^2 + y^2 = a − é',
  parameters: [{ name: 'a', label: 'a', value: -2.5, min: -2.5, max: 1, step: 0.01 }],
  bounds: {
    min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
    max: /** @type {[number, number, number]} */ ([1, 1, 2]),
  },
};

/**
 * @param {number[][]} places
 * @param {Partial<Record<'levels' | 'parents' | 'fronts', number[]>>} [more]
 * @returns {any}
 */
const particles = (places, { levels = [], parents = [], fronts = [] } = {}) => ({
  positions: Float32Array.from(places.flat()),
  normals: Float32Array.from(places.flat()),
  radii: new Float32Array(places.length).fill(0.5),
  levels: Uint32Array.from(levels),
  parents: Uint32Array.from(parents),
  fronts: Uint32Array.from(fronts),
});

test('an address is read as it was written, and a bare anchor is one', () => {
  const address = { stop: 'what-if-order', parts: { surface: 'abc_-', on: 'torus' } };
  expect(readAddress(writeAddress(address))).toEqual(address);
  expect(readAddress('#rings')).toEqual({ stop: 'rings', parts: {} });
  expect(readAddress('#surface=abc')).toEqual({ stop: '', parts: { surface: 'abc' } });
  expect(readAddress('#rings&unknown=1&%E0%A4%A=2').parts).toEqual({});
  expect(writeAddress({ stop: '', parts: {} })).toBe('');
});

test('a link to what the lesson no longer has leads to what is nearest by its content, without slides', () => {
  const stops = ['why', 'plane', 'rings', 'judge', 'cost', 'what-if', 'what-if-fail'];
  for (const [old, stop] of [
    ['rings', 'rings'],
    ['what-if-fail', 'what-if-fail'],
    ['race', 'cost'],
    ['moving', 'cost'],
    ['predict-moving', 'cost'],
    ['predict-hole', 'predict-seam'],
    ['predict-cost', 'predict-pushes'],
    ['predict-few', 'judge'],
    ['what-if-order', 'what-if'],
    ['ringz', ''],
    ['toString', ''],
  ])
    expect(stopFor(old, stops), old).toBe(stop);
  expect(readAddress('#rings&mode=present')).toEqual({ stop: 'rings', parts: {} });
});

test('a surface comes out of a link as it went in, with the way back', () => {
  const carried = { surface: SURFACE, from: '#v1.j.eyJ9' };
  const read = unpackCarried(packCarried(carried));
  expect(read).toEqual(carried);
  expect(unpackCarried(packCarried({ surface: null, from: '' }))).toEqual({ surface: null, from: '' });
});

test('a damaged surface is refused, and a way back that is none is dropped', () => {
  for (const bad of [
    '',
    '!',
    'AAAA',
    packed(3),
    packed({ formula: 1 }),
    packed({ ...SURFACE, bounds: { min: [0, 0, 0], max: [1, 0, 1] } }),
  ])
    expect(unpackCarried(bad), bad).toBe(null);
  expect(unpackCarried(packed({ from: 'javascript:alert(1)' }))).toEqual({ surface: null, from: '' });
  expect(unpacked('A'.repeat(100_000))).toBe(null);
});

test('the lesson says which surface stands in, and why', () => {
  expect(subjectOf(undefined)).toMatchObject({ isOwn: false, notice: '' });
  expect(subjectOf('%%%').notice).toContain('no surface that can be read');
  expect(subjectOf(packCarried({ surface: null, from: '' })).notice).toContain('points');
  expect(subjectOf(packCarried({ surface: SURFACE, from: '' }))).toMatchObject({ isOwn: true, surface: SURFACE });
});

test('the nearest distance is that of a pair, over the sum of the radii', () => {
  const found = nearestDistances(
    particles([
      [0, 0, 0],
      [0.8, 0, 0],
      [1.9, 0, 0],
      [40, 0, 0],
    ]),
  );
  expect([...found.slice(0, 2)].map((v) => Number(v.toFixed(3)))).toEqual([0.8, 0.8]);
  expect(found[2]).toBeCloseTo(1.1);
  expect(found[3]).toBe(Infinity);
});

test('rings are counted on the first front alone', () => {
  const places = Array.from({ length: 5 }, () => [0, 0, 0]);
  expect(ringsOf(particles(places, { levels: [0, 1, 1, 0, 3], fronts: [0, 0, 0, 1, 0] }))).toEqual([1, 2, 0, 1]);
});

test('the sharpest bend is where the normals of parent and child differ most', () => {
  const none = 0xffffffff;
  const found = sharpestBend(
    particles(
      [
        [0, 0, 1],
        [0, 0.6, 0.8],
        [0, 1, 0],
      ],
      { parents: [none, 0, 1] },
    ),
  );
  expect(found).toEqual({ child: 2, parent: 1 });
  expect(sharpestBend(particles([[0, 0, 1]], { parents: [none] }))).toBe(null);
});

test('a fine sampling counts areas', () => {
  expect(asFineEverywhere([1, 2])).toBe(5);
});

test('an assignment comes out of a link as it went in, and what is damaged of it is set right', () => {
  const task = {
    title: 'Seams',
    setup: { on: 'torus', left: 'queue~0.7~10~0', right: 'stack~0.95~0~2' },
    locks: /** @type {Control[]} */ (['on', 'right']),
    questions: ['Why?', 'Where?'],
  };
  expect(unpackTask(packTask(task))).toEqual(task);
  const pressed = { on: '', left: USUAL, right: turned(USUAL, SEED, seedAt([0.123456, -1, 1e-7])) };
  expect(pressed.right).toBe('queue~0.7~10~at 0.1235 -1 1e-7');
  expect(unpackTask(packed({ setup: pressed, questions: [] }))?.setup).toEqual(pressed);
  const stack = 'stack~0.7~10~0';
  for (const right of ['at 1 x 2', 'heap~0.7~10~0', 'stack~0.1~10~0', 'stack~0.7~10', 'stack~0.7~10~at 1 x 2'])
    expect(unpackTask(packed({ setup: { ...pressed, right }, questions: [] }))?.setup.right, right).toBe(stack);
  // A link from before there was a choice of surfaces, and of a lock that is gone.
  const odd = unpackTask(packed({ setup: { left: 9, right: '1' }, locks: ['race'], questions: [3, 'x'.repeat(999)] }));
  expect(odd).toMatchObject({ title: '', setup: { on: '', left: USUAL, right: stack }, locks: [] });
  expect(odd?.questions.map(({ length }) => length)).toEqual([1, 500]);
  for (const bad of ['', 'AAAA', packed(null), packed({ questions: [] }), packed({ setup: 'none', questions: [] })])
    expect(unpackTask(bad)).toBe(null);
});

test('the table of all works quotes what needs it and starts no formula', () => {
  const work = {
    assignment: '=SUM(A1)',
    surface: 'x = 1',
    name: 'Ada',
    group: '',
    answers: [{ question: 'Why, and "how"?', answer: '-3' }],
    predictions: [{ stop: 'predict-ring', question: 'Q', guess: 66, answer: 'A' }],
    runs: [{ label: 'queue', figures: { six: 0.9 }, new_per_level: [1, 6], fates_per_level: [{ added: 6 }] }],
  };
  expect(tableOfAll([work]).split('\r\n')).toEqual([
    'work,part,name,number,value',
    "1,assignment,title,,'=SUM(A1)",
    '1,assignment,surface,,x = 1',
    '1,assignment,name,,Ada',
    '1,assignment,class,,',
    '1,answer,"Why, and ""how""?",,-3',
    '1,prediction,Q,,66',
    '1,run,Q,,A',
    '1,run 1,label,,queue',
    '1,run 1,figures: six,,0.9',
    '1,run 1,new_per_level,0,1',
    '1,run 1,new_per_level,1,6',
    '1,run 1,fates_per_level: added,0,6',
    '',
  ]);
});

test('a work is read from the file that it was saved as, and nothing else is one', () => {
  const work = {
    assignment: 'Seams',
    surface: 'x = 1',
    name: 'Ada',
    group: '7b',
    answers: [{ question: 'Why?', answer: 'So.' }],
    predictions: [{ stop: 'predict-ring', question: 'Q', guess: 66, answer: 'A' }],
    runs: [{ label: 'queue', figures: null }],
  };
  expect(readWork(JSON.stringify(work))).toEqual(work);
  // A file from before there were names.
  const { name: _name, group: _group, ...old } = work;
  expect(readWork(JSON.stringify(old))).toMatchObject({ name: '', group: '' });
  for (const bad of [
    '',
    '{',
    'null',
    '[]',
    '3',
    '{}',
    JSON.stringify({ ...work, answers: 'no' }),
    JSON.stringify({ ...work, runs: [null] }),
  ])
    expect(readWork(bad), bad).toBe(null);
});

/** A score of 1,500 particles. @param {object} figures @returns {any} */
const scored = (figures) => ({
  six: 0.9,
  hole: 1.2,
  pair: 0.75,
  uncovered: 0.1,
  count: 1500,
  evaluations: 20,
  ...figures,
});

test('of two figures the better one is marked where they differ by more than chance, as they are written', () => {
  const best = (/** @type {any} */ key, /** @type {number} */ one, /** @type {number} */ other, count = 1500) =>
    bestOf([scored({ count, [key]: one }), scored({ count, [key]: other })], rowOf(key));
  expect(best('six', 0.953, 0.9)).toBe(0);
  expect(best('six', 0.952, 0.9)).toBe(-1);
  // Rounded to what is written, 95.2 % and 90.0 %.
  expect(best('six', 0.9524, 0.8996)).toBe(-1);
  // With a quarter of the particles chance is twice as large.
  expect(best('six', 0.95, 0.85, 375)).toBe(-1);
  expect(best('six', 0.95, 0.84, 375)).toBe(0);
  expect(best('hole', 1.35, 1.2)).toBe(-1);
  expect(best('hole', 1.36, 1.2)).toBe(1);
  expect(best('pair', 0.75, 0.67)).toBe(-1);
  expect(best('pair', 0.75, 0.66)).toBe(0);
  expect(best('evaluations', 20, 18)).toBe(1);
  // The count and the cover are not judged.
  expect(best('count', 1500, 1000)).toBe(-1);
  expect(best('uncovered', 0.1, 0.9)).toBe(-1);
  expect(bestOf([scored({ six: null }), scored({})], rowOf('six'))).toBe(-1);
});

test('order decides where it differs by more than chance, then the hole, then the pair, else nothing', () => {
  const worse = { six: 0.8, hole: 1.5, pair: 0.6 };
  const verdict = (/** @type {object} */ one, /** @type {object} */ other) => verdictOf([scored(one), scored(other)]);
  expect(verdict({ six: worse.six }, { hole: worse.hole, pair: worse.pair })).toEqual({ key: 'six', side: 1 });
  expect(verdict({ six: 0.91, hole: worse.hole }, { six: 0.89, pair: worse.pair })).toEqual({ key: 'hole', side: 1 });
  expect(verdict({ hole: 1.3 }, { pair: worse.pair })).toEqual({ key: 'pair', side: 0 });
  expect(verdict({ six: 0.93, hole: 1.3, pair: 0.7, evaluations: 5 }, {})).toBe(null);
  expect(verdictOf([scored({ evaluations: 5 }), scored({})], ['six', 'evaluations'])).toEqual({
    key: 'evaluations',
    side: 0,
  });
});

test('a score is of the report’s own figures, of particles of many sizes of those against each size', async () => {
  const quality = {
    six_neighbours: 0.9,
    cover: 1.2,
    cover_local: 1.3,
    uncovered: 0.1,
    rho: 0.8,
    overlap_min: 0.7,
    area: 4,
  };
  const places = {
    holes: [{ position: [0.9, 0, 0], radius: 0.4, ratio: 1.2 }],
    pairs: [{ particles: [0, 2], ratio: 0.8 }],
  };
  const lab = /** @type {any} */ ({ measure: async () => ({ quality, places, valence: new Uint8Array(3) }) });
  const some = particles([
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
  ]);
  const even = await scoreOf(lab, some, { evaluations: 30, isAdaptive: false });
  expect(even).toMatchObject({ six: 0.9, hole: 1.2, uncovered: 0.1, pair: 0.8, evaluations: 10 });
  expect(even.count).toBe(3);
  expect(even.places.hole).toMatchObject({ places: [[0.9, 0, 0]], radius: 0.4, normal: [1, 0, 0] });
  expect(even.places.pair?.places).toEqual([
    [0, 0, 0],
    [0, 1, 0],
  ]);
  expect(await scoreOf(lab, some, { evaluations: 30, isAdaptive: true })).toMatchObject({ hole: 1.3, pair: 0.7 });
});

test('what a learner has guessed is there again, and gone once it is forgotten', () => {
  let text = '';
  const keep = (/** @type {string} */ now) => {
    text = now;
  };
  const first = new Stops('', keep);
  expect(first.isBegun()).toBe(false);
  first.record({ stop: 'predict-ring', question: 'Q', guess: 66, right: 65, answer: 'A' });
  first.keepMore('plane-plane', { turn: 2 });
  const again = new Stops(text, keep);
  expect(again.predictions()).toEqual([{ stop: 'predict-ring', question: 'Q', guess: 66, right: 65, answer: 'A' }]);
  expect([again.isOpen('predict-ring'), again.isOpen('predict-seam')]).toEqual([true, false]);
  expect(again.more('plane-plane')).toEqual({ turn: 2 });
  again.forget();
  expect(new Stops(text).isBegun()).toBe(false);
  for (const damaged of ['{', 'null', '3']) expect(new Stops(damaged).isBegun()).toBe(false);
});

test('the cell of a place of the hexagonal pattern has six corners, and that of a square four', () => {
  const six = Array.from(
    { length: 6 },
    (_, k) => /** @type {[number, number]} */ ([2 * Math.cos((k * Math.PI) / 3), 2 * Math.sin((k * Math.PI) / 3)]),
  );
  const cell = cellOf([0, 0], [...six, [4, 0]], 5);
  expect(cell).toHaveLength(6);
  for (const [x, y] of cell) expect(Math.hypot(x, y)).toBeCloseTo(2 / Math.sqrt(3), 9);
  expect(
    cellOf(
      [1, 1],
      [
        [1, 1],
        [3, 1],
        [-1, 1],
        [1, 3],
        [1, -1],
      ],
      5,
    ),
  ).toHaveLength(4);
});

test('the heads of a comparison name what differs, and all choices where nothing does', () => {
  const other = turned(turned(USUAL, 0, 'stack'), 1, '0.95');
  expect(knobDifference(USUAL, other)).toEqual(['Queue, 1.4 r', 'Stack, 1.9 r']);
  expect(knobDifference(USUAL, turned(USUAL, 2, '0'))).toEqual(['Ten steps', 'No steps']);
  expect(knobDifference(USUAL, USUAL)).toEqual(Array(2).fill('Queue, 1.4 r, ten steps, seed 0'));
});
