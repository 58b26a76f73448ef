/** Adaptive runs, and the colours that belong to them: radius, curvature and component. */
import { expect, test } from 'vitest';
import { open, pause, picture, until } from './engine.js';

/** Some 900 particles, of which the largest are several times the smallest. */
const adaptive = { sampling: 'adaptive', chord_error: 6e-4, radius_min_share: 0.002, radius_max_share: 0.05 };
/** A spindle: sharp at its ends, nearly straight between. */
const spindle = { formula: 'x^2/4 + 6 y^2 + 6 z^2 = 1', bounds: { min: [-2.2, -0.6, -0.6], max: [2.2, 0.6, 0.6] } };

test('radius and curvature colour the surface by a ramp that follows it', async () => {
  const p = await open();
  const legend = () => p.engine.legend.value;
  await p.set({ ...spindle, settings: adaptive, view: { colour: 'radius' } });
  expect(legend()).toMatchObject({ kind: 'sequential', pending: false });
  const [low, high] = legend()?.range ?? [0, 0];
  expect(high / low).toBeGreaterThan(1.8);
  expect((await picture(p)).hues).toBeGreaterThanOrEqual(4);

  // Dented like a peanut: it bulges at the ends and is hollow in the middle.
  const peanut = {
    formula: '(x^2 + y^2 + z^2 + 1)^2 - 4 x^2 = 1.2',
    bounds: { min: [-1.8, -1, -1], max: [1.8, 1, 1] },
  };
  await p.set({ ...peanut, settings: { radius_share: 0.02 }, view: { colour: 'curvature' } });
  await until(p.engine.legend, (now) => now?.pending === false);
  const [least, most] = legend()?.range ?? [0, 0];
  expect(legend()?.kind).toBe('diverging');
  expect(least).toBe(-most);
  expect(most).toBeGreaterThan(0.5);
  const curvature = p.particles().curvature ?? [];
  expect(curvature.length).toBe(2 * p.particles().count);
  for (let i = 0; i < curvature.length; i += 2) expect(curvature[i]).toBeGreaterThanOrEqual(curvature[i + 1]);
});

test('the curvature of a sphere is that of a sphere, also when it is asked for after the run', async () => {
  const p = await open();
  await p.set({ formula: 'x^2 + y^2 + z^2 = 0.25', settings: { radius_share: 0.03 }, view: { colour: 'level' } });
  expect(p.particles().curvature).toBe(null);
  p.engine.setView({ colour: 'curvature' });
  await until(p.engine.legend, (now) => now?.kind === 'diverging' && !now.pending);
  expect(p.particles().curvature).not.toBe(null);
  for (const k of p.particles().curvature ?? []) expect(k).toBeCloseTo(2, 3);
});

test('components have colours of their own, with their counts', async () => {
  const p = await open();
  const three = 'min((x-1.2)^2 + y^2 + z^2 - 0.3, (x+1.2)^2 + y^2 + z^2 - 0.2, x^2 + (y-1.2)^2 + z^2 - 0.1)';
  const report = await p.set({
    formula: three,
    bounds: { min: [-2, -1, -1], max: [2, 2, 1] },
    settings: { radius_share: 0.02 },
    view: { colour: 'component' },
  });
  expect(report?.components).toBe(3);
  const counts = p.engine.legend.value?.entries?.map(({ count = 0 }) => count) ?? [];
  expect(counts).toHaveLength(3);
  expect(counts).toEqual([...counts].sort((a, b) => b - a));
  expect(counts.reduce((sum, n) => sum + n, 0)).toBe(report?.count);
  expect((await picture(p)).hues).toBeGreaterThanOrEqual(2);
  const { component, positions, count } = p.particles();
  for (let i = 0; i < count; i += 1)
    expect(component?.[i]).toBe(positions[3 * i + 1] > 0.7 ? 2 : positions[3 * i] > 0 ? 0 : 1);
});

test('a setting of an adaptive run dragged at 60 Hz ends at its last value', async () => {
  const p = await open();
  await p.set({ settings: adaptive });
  for (let k = 0; k < 60; k += 1) {
    p.engine.setSetting('chord_error', 6e-4 - 9e-6 * k, { live: true });
    await pause(16);
  }
  p.engine.setSetting('chord_error', 6e-5);
  const report = await until(p.engine.report, (now) => now);
  expect(p.state.settings.chord_error).toBe(6e-5);
  expect(p.engine.lastDrag.value?.shown).toBeGreaterThan(0);
  const whole = await p.set({ settings: { ...adaptive, chord_error: 6e-5 } });
  expect(report?.digest).toBe(whole?.digest);
  expect(p.status()).toMatchObject({ notice: null });
});

test('a link holds every setting of an adaptive run', async () => {
  const p = await open();
  const settings = { ...adaptive, radius_law: 'sum_of_curvatures', curvature_scale: 0.11, grading: 0.3 };
  const before = await p.set({ ...spindle, settings, view: { colour: 'radius' } });
  const other = await open(await p.engine.link());
  expect(other.state.settings).toEqual(settings);
  expect(other.state.view.colour).toBe('radius');
  expect(other.report()?.digest).toBe(before?.digest);
});
