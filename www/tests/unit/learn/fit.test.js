/** The room that bodies take in a picture of the lesson. */
import { expect, test } from 'vitest';
import { triple } from '../../../src/engine/vector.js';
import { projected, viewOf } from '../../../src/engine/view/camera.js';
import { Fit } from '../../../src/learn/fit.js';

/** Discs on an ellipsoid that is not in the middle of space. */
const COUNT = 600;
const radii = new Float32Array(COUNT).fill(0.03);
const positions = new Float32Array(3 * COUNT);
for (let k = 0; k < COUNT; k += 1) {
  const z = 1 - (2 * k + 1) / COUNT;
  const [turn, far] = [k * Math.PI * (3 - Math.sqrt(5)), Math.sqrt(1 - z * z)];
  positions.set([5 + 2 * far * Math.cos(turn), far * Math.sin(turn), 0.4 * z - 1], 3 * k);
}

test.each([
  { width: 300, height: 200 },
  { width: 200, height: 500 },
])('bodies fill a picture of $width × $height from every side, and nothing is cut off', ({ width, height }) => {
  const fit = new Fit([{ positions, radii }]);
  for (const pitch of [0, 0.4, -0.9]) {
    /** The largest share of the half width and of the half height that is reached. */
    const most = [0, 0];
    const { ball, distance } = fit.in(pitch, { width, height });
    for (let yaw = 0; yaw < 2 * Math.PI; yaw += 0.1) {
      const camera = { yaw, pitch, target: ball.centre, distance, fit: true };
      const view = viewOf(camera, width, height, ball, undefined, true);
      for (let i = 0; i < COUNT; i += 1) {
        const at = projected(view, triple(positions, i));
        if (!at) throw new Error('behind the eye');
        const own = radii[i] / at.perPx;
        most[0] = Math.max(most[0], (Math.abs(at.x - width / 2) + own) / (width / 2));
        most[1] = Math.max(most[1], (Math.abs(at.y - height / 2) + own) / (height / 2));
      }
    }
    expect(Math.max(...most)).toBeLessThanOrEqual(1);
    expect(Math.max(...most)).toBeGreaterThan(0.9);
  }
});

test('several bodies are seen whole', () => {
  const aside = { positions: Float32Array.of(9, 0, 0), radii: Float32Array.of(1) };
  const size = { width: 100, height: 100 };
  const alone = new Fit([{ positions, radii }]).in(0, size);
  const both = new Fit([{ positions, radii }, aside]).in(0, size);
  expect(both.ball.centre[0]).toBeCloseTo(6);
  expect(both.distance / alone.distance).toBeCloseTo((4 / 2.03) * 1, 1);
});
