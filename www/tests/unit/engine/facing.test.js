import { describe, expect, test } from 'vitest';
import { widestYaw } from '../../../src/engine/view/facing.js';

/** Points of a disc about the origin. @param {(u: number, v: number) => number[]} place */
function disc(place) {
  const positions = [];
  for (let u = -1; u <= 1; u += 0.05)
    for (let v = -1; v <= 1; v += 0.05) if (u * u + v * v <= 1) positions.push(...place(u, v));
  return { positions, count: positions.length / 3 };
}
const ball = { centre: /** @type {[number, number, number]} */ ([0, 0, 0]), radius: 1 };

describe('the yaw of the largest outline', () => {
  test('faces an upright disc', () => {
    for (const facing of [-2, -0.7, 0.3, 1.4]) {
      const [s, c] = [Math.sin(facing), Math.cos(facing)];
      const yaw = widestYaw(
        { yaw: facing + 1.5, pitch: 0 },
        disc((u, v) => [-u * s, u * c, v]),
        ball,
      );
      expect(Math.abs(Math.cos(yaw - facing)), `a disc that faces ${facing}`).toBeGreaterThan(0.85);
    }
  });

  test('is the present one where others are hardly better', () => {
    const lying = disc((u, v) => [u, v, 0]);
    for (const yaw of [0, 0.62, -2]) expect(widestYaw({ yaw, pitch: 0.4 }, lying, ball)).toBe(yaw);
  });
});
