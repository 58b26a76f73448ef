/** Formulas as they are typed: what stays meanwhile, and where the camera goes. */
import { describe, expect, test } from 'vitest';
import { TYPING_MS } from '../../src/engine/constants.js';
import { eventually, open, turn, until } from './engine.js';

/** @import { Console } from '../../src/main/types.js' */

/** Waits until nothing runs and the figures are there, or there is no surface. @param {Console} p */
async function settled({ engine, debug }) {
  await eventually(
    () =>
      engine.status.value !== 'sampling' &&
      engine.progress.value.phase === 'done' &&
      (engine.report.value || engine.result.value === 'none'),
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
    // The worker tells of the relaxation only if it takes longer than a picture.
    engine.setSetting('relax_steps', 100);
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
    await turn(2 * TYPING_MS);
    await p.debug.still();
    const { camera } = p.state.view;
    for (const text of ['x^2 + 1', 'x^2 + y^2 + z^2 = -9']) {
      p.engine.setFormula(text);
      await until(p.engine.result, (result) => result === 'none');
      await turn(2 * TYPING_MS);
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
    await until(p.engine.result, (result) => result === 'none');
    p.engine.fit();
    await p.debug.still();
    expect(p.state.view.camera.distance).toBeGreaterThan(distance);
  });
});

/** Lets the hand that types rest. @param {Console} p */
async function paused({ engine }) {
  await turn(TYPING_MS);
  expect(engine.trial.value).not.toBe('typing');
}

describe('while somebody types', () => {
  /** Types a text letter by letter, and returns what of the page has changed meanwhile. @param {Console} p @param {string} text */
  async function type({ engine }, text) {
    const seen = () => ({
      run: engine.progress.value.run,
      digest: engine.report.value?.digest,
      field: engine.field.value,
      fault: engine.fieldError.value,
      camera: engine.state.value.view.camera,
    });
    const before = seen();
    for (let k = 1; k <= text.length; k += 1) {
      engine.setFormula(text.slice(0, k), { typing: true });
      await turn(30);
    }
    const after = seen();
    expect(after).toEqual(before);
    expect(engine.trial.value).toBe('typing');
  }

  test('no beginning of a formula is sampled, and the pause brings the whole of it', async () => {
    const p = await open();
    await type(p, 'x^2+y^2+z^2=1');
    await paused(p);
    await settled(p);
    expect(p.report()).toMatchObject({ quality: { euler: 2 }, border: 0 });
    expect(p.state.bounds).toBe(null);
    const { min, max } = p.engine.field.value?.bounds ?? { min: [], max: [] };
    for (const k of [0, 1, 2]) {
      expect(max[k] - min[k]).toBeGreaterThan(2);
      expect(max[k] - min[k]).toBeLessThan(2.7);
    }
  });

  test('a formula without a surface leaves the surface that stood before, and the camera with it', async () => {
    const p = await open();
    const { positions, camera } = { ...p.particles(), camera: p.state.view.camera };
    await type(p, 'x^2+y^2+z^2=-1');
    await until(p.engine.result, (result) => result === 'none');
    const { columns } = p.engine;
    expect(columns.positions.slice(0, 3 * columns.count)).toEqual(positions);
    expect(p.state.view.camera).toEqual(camera);
  });

  /** Types a text with a pause at every letter, in which it is sampled. @param {Console} p @param {string} text */
  async function typeSlowly(p, text) {
    const { engine } = p;
    let trials = 0;
    for (let k = 1; k <= text.length; k += 1) {
      engine.setFormula(text.slice(0, k), { typing: true });
      await paused(p);
      await eventually(() => engine.status.value).not.toBe('sampling');
      if (engine.trial.value === 'shown') trials += 1;
    }
    await settled(p);
    return trials;
  }

  for (const [what, text, count] of /** @type {const} */ ([
    ['without a surface', 'x^2+y^2+z^2=-1', 0],
    ['with a mistake', 'x+y^2+siin(z', 1],
  ]))
    test(`a formula ${what}, whose beginnings have surfaces, brings back the one before them`, async () => {
      const p = await open();
      const { positions, view } = { ...p.particles(), view: p.state.view };
      const report = p.report();
      expect(await typeSlowly(p, text)).toBeGreaterThan(2);
      await eventually(() => p.engine.trial.value).not.toBe('shown');
      await settled(p);
      const { columns } = p.engine;
      expect(columns.positions.slice(0, 3 * columns.count)).toEqual(positions);
      expect(p.state.view.camera).toEqual(view.camera);
      expect(p.debug.counts().dimmed).toBe(true);
      // Where no surface is found, the one in the picture is not measured or saved; beside a mistake it is.
      expect(p.particles().count).toBe(count * columns.count);
      expect(p.report()?.digest).toBe(count ? report?.digest : undefined);
      expect(p.engine.result.value === 'none').toBe(count === 0);
    });

  test('a formula that has a surface is fitted, and stands after another pause, or at once by Enter', async () => {
    const p = await open();
    const { distance } = p.state.view.camera;
    for (const [text, enter] of /** @type {const} */ ([
      ['x^2+y^2+z^2=25', false],
      ['x^2+y^2+z^2=400', true],
    ])) {
      const before = p.state.view.camera.distance;
      await type(p, text);
      await paused(p);
      await eventually(() => p.engine.status.value).not.toBe('sampling');
      expect(p.engine.trial.value).toBe('shown');
      if (enter) p.engine.setFormula(text);
      else await until(p.engine.trial, (trial) => trial === 'none');
      await eventually(() => p.state.view.camera.distance / before).toBeGreaterThan(2);
      expect(p.engine.trial.value).toBe('none');
      const { positions } = p.particles();
      await typeSlowly(p, 'x+y^2+siin(z');
      await eventually(() => p.particles().positions).toEqual(positions);
      expect(p.state.view.camera.distance / before).toBeGreaterThan(2);
    }
    p.engine.setFormula('x^2+y^2+z^2=-400', { typing: true });
    await until(p.engine.result, (result) => result === 'none');
    await p.debug.still();
    expect(p.state.view.camera.distance / distance).toBeGreaterThan(8);
  });

  test('the same text once more, as by Enter, or another control samples it without a pause', async () => {
    const p = await open();
    for (const finish of [
      () => p.engine.setFormula(p.state.formula),
      () => p.engine.setSetting('seed', 1),
      () => p.engine.run(),
    ]) {
      p.engine.setFormula(`x^2+y^2+z^2=${p.state.formula.length}`, { typing: true });
      expect(p.engine.status.value).not.toBe('sampling');
      finish();
      expect(p.engine.status.value).toBe('sampling');
      expect(p.engine.trial.value).not.toBe('typing');
      await settled(p);
      expect(p.engine.field.value?.formula).toBe(p.state.formula);
    }
  });

  test('a mistake is told once the typing pauses', async () => {
    const p = await open();
    await type(p, 'x^2 + siin(y');
    await until(p.engine.fieldError, (error) => error?.kind === 'unknown_function');
    expect(p.engine.trial.value).not.toBe('typing');
  });
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
