import { describe, expect, test } from 'vitest';
import { LIVE_MS, Pace, paceKey, sizeOf } from '../../../src/engine/sampling/pace.js';

describe('coarse to fine', () => {
  const settings = { size_mode: 'radius', radius_share: 0.006, count: 10_000, relax_steps: 10, max_particles: 200_000 };
  const seconds = (/** @type {number} */ n) => ({
    seeding: 0.004,
    generation: n * 1.2e-6,
    refinement: 0,
    relaxation: n * 10 * 0.3e-6,
    quality: 0,
  });
  const diagonal = 4;
  const radius = 0.006 * diagonal;

  test('a run that fits is made whole', () => {
    const pace = new Pace();
    pace.record({ seconds: seconds(8000), particles: 8000, relax_steps: 10, size: radius });
    expect(pace.milliseconds(8000, 10)).toBeCloseTo(4 + 8000 * 4.2e-3, 6);
    expect(pace.plan(settings, diagonal)).toEqual({ settings, coarse: false });
  });

  test('a run that does not fit is made with as many particles as do', () => {
    const pace = new Pace();
    pace.record({ seconds: seconds(100_000), particles: 100_000, relax_steps: 10, size: radius });
    const plan = pace.plan(settings, diagonal);
    expect(plan.coarse).toBe(true);
    const n = pace.expected(plan.settings, diagonal);
    expect(pace.milliseconds(n, Number(plan.settings.relax_steps))).toBeCloseTo(LIVE_MS, 3);
    expect(n).toBeGreaterThan(10_000);
    expect(Number(plan.settings.relax_steps)).toBeLessThan(10);
  });

  test('a wanted count is turned into a radius while dragging', () => {
    const pace = new Pace();
    pace.record({ seconds: seconds(100_000), particles: 100_000, relax_steps: 10, size: radius });
    const plan = pace.plan({ ...settings, size_mode: 'count', count: 150_000 }, diagonal);
    expect(plan.settings.size_mode).toBe('radius');
    expect(pace.expected(plan.settings, diagonal)).toBeLessThan(60_000);
  });

  test('a refined run keeps its settings and ends at its coarse level while it is dragged', () => {
    const refined = { ...settings, method: 'refined' };
    const pace = new Pace();
    pace.record({ seconds: seconds(100_000), particles: 100_000, relax_steps: 10, size: radius });
    expect(pace.plan(refined, diagonal)).toEqual({ settings: refined, coarse: true });
    const fast = new Pace();
    fast.record({ seconds: seconds(2000), particles: 2000, relax_steps: 10, size: radius });
    expect(fast.plan(refined, diagonal)).toEqual({ settings: refined, coarse: false });
  });

  test('before the first run nothing is assumed', () => {
    expect(new Pace().plan(settings, diagonal)).toEqual({ settings, coarse: false });
  });

  test('a graphics device that cannot keep up is given less to draw, and more again when it can', () => {
    const pace = new Pace();
    pace.record({ seconds: seconds(8000), particles: 8000, relax_steps: 10, size: radius });
    for (let k = 0; k < 20; k += 1) pace.recordPicture(8000, 34 + 160);
    expect(pace.drawUs).toBeCloseTo(20, 1);
    const plan = pace.plan(settings, diagonal);
    expect(plan.coarse).toBe(true);
    expect(pace.expected(plan.settings, diagonal)).toBeLessThan(3000);
    for (let k = 0; k < 30; k += 1) pace.recordPicture(2500, 20);
    expect(pace.plan(settings, diagonal).coarse).toBe(false);
  });

  test('a surface that is slow to find is still drawn with half the time', () => {
    const pace = new Pace();
    pace.record({ seconds: { ...seconds(50_000), seeding: 0.2 }, particles: 50_000, relax_steps: 10, size: radius });
    const plan = pace.plan(settings, diagonal);
    expect(plan.coarse).toBe(true);
    expect(pace.milliseconds(pace.expected(plan.settings, diagonal), Number(plan.settings.relax_steps))).toBeCloseTo(
      200 + LIVE_MS / 2,
      3,
    );
  });

  test('even a very slow machine keeps the shape visible', () => {
    const pace = new Pace();
    pace.record({
      seconds: { seeding: 0.5, generation: 10, refinement: 0, relaxation: 30, quality: 0 },
      particles: 50_000,
      relax_steps: 10,
      size: radius,
    });
    const plan = pace.plan(settings, diagonal);
    expect(Math.round(pace.expected(plan.settings, diagonal))).toBe(500);
  });

  describe('of an adaptive run', () => {
    const adaptive = {
      ...settings,
      sampling: 'adaptive',
      radius_law: 'chord_error',
      chord_error: 4e-5,
      curvature_scale: 0.02,
      radius_min_share: 0.001,
      radius_max_share: 0.03,
    };
    const slow = (/** @type {number} */ n) => ({
      seeding: 0.004,
      generation: n * 6e-6,
      refinement: 0,
      relaxation: n * 10 * 1e-6,
      quality: 0,
    });

    test.each(['chord_error', 'max_curvature', 'sum_of_curvatures'])(
      'scales every radius by one factor: %s',
      (radiusLaw) => {
        const now = { ...adaptive, radius_law: radiusLaw };
        const pace = new Pace();
        pace.record({ seconds: slow(20_000), particles: 20_000, relax_steps: 10, size: sizeOf(now, diagonal) });
        const plan = pace.plan(now, diagonal);
        expect(plan.coarse).toBe(true);
        const n = pace.expected(plan.settings, diagonal);
        expect(pace.milliseconds(n, Number(plan.settings.relax_steps))).toBeCloseTo(LIVE_MS, 3);
        const factor = Math.sqrt(20_000 / n);
        expect(Number(plan.settings.radius_min_share) / now.radius_min_share).toBeCloseTo(factor, 6);
        expect(Number(plan.settings.radius_max_share) / now.radius_max_share).toBeCloseTo(factor, 6);
        expect(sizeOf(plan.settings, diagonal) / sizeOf(now, diagonal)).toBeCloseTo(factor, 6);
      },
    );

    test('by count asks for fewer', () => {
      const now = { ...adaptive, size_mode: 'count', count: 50_000 };
      const pace = new Pace();
      pace.record({ seconds: slow(50_000), particles: 50_000, relax_steps: 10, size: sizeOf(now, diagonal) });
      const plan = pace.plan(now, diagonal);
      expect(plan.settings).toMatchObject({ size_mode: 'count', chord_error: now.chord_error });
      expect(plan.settings.count).toBeLessThan(10_000);
    });

    test('and of points is measured apart from that of a formula', () => {
      const keys = [
        paceKey({ field: { formula: 'x' }, settings }),
        paceKey({ field: { points: 'bunny' }, settings }),
        paceKey({ field: { formula: 'x' }, settings: adaptive }),
        paceKey({ field: { points: 'bunny' }, settings: adaptive }),
        paceKey({ field: { formula: 'x' }, settings: { ...settings, method: 'refined' } }),
      ];
      expect(new Set(keys).size).toBe(5);
    });
  });
});
