/** Solids of several fields, and surfaces by their names, in the packed package. */
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { install, ROUND } from './packed.js';

/** @type {ReturnType<typeof install>} */
let there;
/** @type {typeof import('../../package/index.js')} */
let made;

beforeAll(async () => {
  there = install();
  made = await there.module();
}, 120_000);
afterAll(() => there.remove());

describe('solids of several fields', () => {
  const ball =
    (/** @type {number} */ x) => (/** @type {number} */ px, /** @type {number} */ y, /** @type {number} */ z) =>
      Math.hypot(px - x, y, z) - 1;
  const [left, right] = ['hypot(x + 1, y, z) - 1', 'hypot(x - 1, y, z) - r'];

  test('are a list of whatever can be sampled', async () => {
    const { union } = made;
    const bounds = /** @type {const} */ ({ min: [-3, -2, -2], max: [3, 2, 2] });
    const options = { count: 2000, bounds: { min: [...bounds.min], max: [...bounds.max] } };
    const three = await made.sample(
      union([left, ball(0), right]),
      /** @type {any} */ ({ ...options, params: { r: 1 } }),
    );
    expect(three.params).toEqual({ r: 1 });
    expect(three.report).toMatchObject({ components: 1 });
    const { volume } = await three.mesh();
    const whole = (4 / 3) * Math.PI;
    const lens = (Math.PI * (4 + 1) * 1) / 12;
    expect(Number(volume) / (3 * whole - 2 * lens)).toBeCloseTo(1, 2);
    const nested = union(union(left, ball(0)), right);
    const same = await made.sample(nested, /** @type {any} */ ({ ...options, params: { r: 1 } }));
    expect(same.digest).toBe(three.digest);
    await expect(three.moved({ r: 1.01 })).rejects.toThrow('not for functions, points or unions');
  });

  test('know points, differences, blends and offsets, and are operands of a formula', async () => {
    const { difference, intersection, offset, smoothUnion, sample } = made;
    const volumeOf = async (/** @type {import('../../package/index.js').Field} */ field, options = {}) =>
      Number((await (await sample(field, { count: 1500, ...options })).mesh()).volume);
    const whole = (4 / 3) * Math.PI;
    const lens = (5 * Math.PI) / 12;
    expect((await volumeOf(difference(ball(1), { points: ROUND }))) / (whole - lens)).toBeCloseTo(1, 1);
    const half = await volumeOf(intersection(ball(0), 'z'));
    expect(half / whole).toBeCloseTo(0.5, 2);
    expect((await volumeOf(offset(ball(0), 0.5))) / (whole * 1.5 ** 3)).toBeCloseTo(1, 2);
    expect(await volumeOf(smoothUnion(left, ball(0), 0.3))).toBeGreaterThan(await volumeOf(made.union(left, ball(0))));
    const cut = await volumeOf(made.union(ball(0), ball(0)), { formula: 'max(model, z - h)', params: { h: 0 } });
    expect(cut / whole).toBeCloseTo(0.5, 2);
  });

  test('are refused in words', async () => {
    const { difference, smoothUnion, union } = made;
    const words = (/** @type {unknown} */ field, options = {}) =>
      made.sample(/** @type {any} */ (field), options).catch(({ name, message }) => `${name}: ${message}`);
    expect(await words(union())).toBe('InputError: union: one solid or more, not none.');
    expect(await words(union('x', /** @type {any} */ (7)))).toContain('InputError: field: a formula such as');
    expect(await words(smoothUnion('x', 'y', -1))).toContain('smoothUnion(): width: a number from 0 on, not -1.');
    expect(await words(union(/** @type {any} */ (['x', 'y']), 'z'))).toContain('field: a formula such as');
    expect(await words([[0, 0, 1]])).toMatch(/or a union\(\.\.\.\) of such fields, not an array\.$/);
    expect(await words({ join: 'xor', of: ['x'] })).toContain('join: one of union, intersection,');
    expect(await words(difference('x +', 'y'))).toContain('FormulaError');
    expect(await words(union('x', 'y'), { params: { a: 1 } })).toContain('no parameter “a”');
    expect(await words(union('x', 'y'), { closed: true })).toContain('closed: for a formula by itself');
  });
});

test('the name of a gallery surface is that surface with its box and its parameters', async () => {
  const torus = await made.sample('torus', { count: 800 });
  expect(torus.bounds).toEqual({ min: [-1.65, -1.65, -0.55], max: [1.65, 1.65, 0.55] });
  expect(torus.params).toEqual({ R: 1, r: 0.4 });
  expect(new TextDecoder('latin1').decode(await torus.toFile('ply'))).toContain('"surface":"torus"');
  const thin = await torus.moved({ r: 0.39 });
  expect(Math.max(...thin.points.filter((_, i) => i % 3 === 2))).toBeCloseTo(0.39, 2);
  thin.dispose();
  await expect(made.sample('torus', { params: { q: 1 } })).rejects.toMatchObject({ name: 'InputError' });
  const solid = await made.sample(made.union('torus', 'x^2 + y^2 + z^2 = 0.1'), { count: 500 });
  expect(solid.report).toMatchObject({ components: 2 });
  solid.dispose();
});
