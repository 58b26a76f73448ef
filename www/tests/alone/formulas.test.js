/** Formulas as they are typed: what stays meanwhile, and where the camera goes. */
import { describe, expect, test } from 'vitest';
import { eventually, open, pause, until } from './engine.js';

/** @import { Console } from '../../src/main/types.js' */

/** Waits until nothing runs and the figures are there, or there is no surface. @param {Console} p */
async function settled({ engine, debug }) {
  await eventually(
    () => !engine.busy.value && engine.progress.value.phase === 'done' && (engine.report.value || engine.empty.value),
  ).toBeTruthy();
  await debug.still();
}

for (const phase of /** @type {const} */ (['relaxation', 'quality'])) {
  test(`a mistake typed during the ${phase} leaves the surface whole, with its own figures, in the middle of the picture`, async () => {
    const p = await open();
    const { engine } = p;
    const before = p.report();
    const old = p.state.view.camera;
    engine.setSetting('radius_share', 0.003);
    engine.setFormula('x^2');
    await until(engine.progress, (now) => now.phase === phase && engine.field.value?.formula === 'x^2');
    engine.setFormula('x^2 + sqr(y) + z^2 = k');
    await until(engine.fieldError, (error) => error);
    await settled(p);
    expect(p.report()?.digest).not.toBe(before?.digest);
    const { count, positions } = p.particles();
    expect(p.report()?.count).toBe(count);
    for (let i = 0; i < count; i += 1) expect(Math.abs(positions[3 * i])).toBeLessThan(1e-3);
    // The camera comes once the typing rests: where it then stands is where a fit would put it.
    await eventually(() => p.state.view.camera).not.toEqual(old);
    await p.debug.still();
    const { distance, target } = p.state.view.camera;
    engine.fit();
    await p.debug.still();
    const close = (/** @type {number} */ v) => expect.closeTo(v, 2);
    expect(p.state.view.camera).toMatchObject({ distance: close(distance), target: target.map(close) });
  });
}

describe('the camera', () => {
  test('stays with the last surface where a formula on its way has none, and comes to the next', async () => {
    const p = await open();
    // The longest pause in typing after which the camera moves, and what it takes to move.
    await pause(1200);
    await p.debug.still();
    const { camera } = p.state.view;
    for (const text of ['x^2 + 1', 'x^2 + y^2 + z^2 = -9']) {
      p.engine.setFormula(text);
      await until(p.engine.empty, (empty) => empty);
      await pause(1200);
      await p.debug.still();
      expect(p.state.view.camera).toEqual(camera);
    }
    for (const [text, least, most] of /** @type {const} */ ([
      ['x^2 + y^2 + z^2 = 9', 1.5, Infinity],
      ['x^2 + y^2 + z^2 = 0.01', 0, 0.25],
    ])) {
      p.engine.setFormula(text);
      await settled(p);
      await eventually(() => p.state.view.camera.distance / camera.distance).toBeGreaterThan(least);
      await eventually(() => p.state.view.camera.distance / camera.distance).toBeLessThan(most);
    }
  });

  test('shows the last surface together with the box in which there is none, where it is asked to fit', async () => {
    const p = await open();
    await p.set({ settings: { box_mode: 'fixed' } });
    const { distance } = p.state.view.camera;
    p.engine.setFormula('x^2 + y^2 + (z - 60)^2 = 1');
    await until(p.engine.empty, (empty) => empty);
    p.engine.fit();
    await p.debug.still();
    expect(p.state.view.camera.distance).toBeGreaterThan(distance);
  });
});

test('a sphere typed letter by letter over the ellipsoid is whole', async () => {
  const p = await open();
  const text = 'x^2+y^2+z^2=1';
  for (let k = 0; k <= text.length; k += 1) {
    p.engine.setFormula(text.slice(0, k), { unfinished: k < text.length });
    await pause(30);
  }
  await settled(p);
  expect(p.report()).toMatchObject({ quality: { euler: 2 }, border: 0 });
  expect(p.state.bounds).toBe(null);
  const { min, max } = p.engine.field.value?.bounds ?? { min: [], max: [] };
  for (const k of [0, 1, 2]) {
    expect(max[k] - min[k]).toBeGreaterThan(2);
    expect(max[k] - min[k]).toBeLessThan(2.3);
  }
});

test('of an endless surface of short period the box holds two periods', async () => {
  const p = await open();
  p.engine.setFormula('cos(10x)+cos(10y)+cos(10z)');
  await settled(p);
  for (const end of p.engine.field.value?.bounds.max ?? []) expect(end).toBeCloseTo(Math.PI / 5, 6);
  expect(p.engine.field.value?.reach).toBe('endless');
});

test('a key typed while the box of a heavy formula is searched is answered', async () => {
  const p = await open();
  const terms = Array.from({ length: 60 }, (_, k) => `sin(${k + 1}x+y)cos(${k + 2}z)`);
  const heavy = `z = ${terms.join('+')}`;
  p.engine.setFormula(heavy);
  p.engine.setFormula(`${heavy}+foo(`);
  await until(p.engine.fieldError, (error) => error);
  p.engine.setFormula('x^2+y^2+z^2=1');
  await settled(p);
  expect(p.report()?.quality?.euler).toBe(2);
});

test('LaTeX is read as it is pasted', async () => {
  const p = await open();
  p.engine.setFormula(String.raw`f(x,y,z) = \frac{x^{2}}{4} + \left|y\right|^2 + z**2 - 1`);
  await settled(p);
  expect(p.report()?.quality?.euler).toBe(2);
});
