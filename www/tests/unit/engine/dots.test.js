import { expect, test } from 'vitest';
import { homeCamera, viewOf } from '../../../src/engine/view/camera.js';
import { dotsOf } from '../../../src/engine/view/dots.js';

const scene = { centre: /** @type {[number, number, number]} */ ([0, 0, 0]), radius: 2 };
const palette = { ink: 0xff000000, casing: 0xffffffff };

test('a dot is as large on the screen wherever it is, and faces the eye', () => {
  const view = viewOf(homeCamera(), 800, 600, scene);
  const points = Float32Array.of(0, 0, 0, 1, 1, 0.5, -1, 0.3, -1);
  const dots = dotsOf(points, view, { px: 2, size: 0.92, lift: 0.02, palette });
  expect(dots.radii).toHaveLength(6);
  for (let j = 0; j < 6; j += 1) {
    const at = [0, 1, 2].map((k) => points[3 * (j >> 1) + k]);
    const depth = [0, 1, 2].reduce((sum, k) => sum + (at[k] - view.eye[k]) * view.forward[k], 0);
    // Ink at odd places, its casing before it; the renderer multiplies by the disc size.
    expect((dots.radii[j] * 0.92) / (view.worldPerPx * depth)).toBeCloseTo(j & 1 ? 1.7 : 2.6, 4);
    expect(dots.colours[j]).toBe(j & 1 ? palette.ink : palette.casing);
    const toEye = [0, 1, 2].map((k) => view.eye[k] - dots.positions[3 * j + k]);
    const length = Math.hypot(...toEye);
    for (const k of [0, 1, 2]) expect(dots.normals[3 * j + k]).toBeCloseTo(toEye[k] / length, 5);
    const lifted = Math.hypot(...at.map((v, k) => v - dots.positions[3 * j + k]));
    expect(lifted).toBeGreaterThan(0.0199);
    if (j & 1) expect(lifted).toBeGreaterThan(0.02);
  }
});

test('a dot hardly grows in a picture of few pixels', () => {
  const view = viewOf(homeCamera(), 800, 600, scene);
  const [usual, coarse] = [1, 0.4].map((px) => dotsOf(new Float32Array(3), view, { px, size: 1, lift: 0.02, palette }));
  expect(coarse.radii[0] / usual.radii[0]).toBeLessThan(1.25);
});

test('a point at the eye or behind it does no harm', () => {
  const view = viewOf(homeCamera(), 800, 600, scene);
  const behind = view.eye.map((v, k) => v - view.forward[k]);
  const dots = dotsOf(Float32Array.of(...view.eye, ...behind), view, { px: 1, size: 1, lift: 0.1, palette });
  for (const column of [dots.positions, dots.normals, dots.radii])
    expect([...column].every(Number.isFinite)).toBe(true);
});
