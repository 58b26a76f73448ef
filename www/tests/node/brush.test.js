/** What is painted finer and coarser, as the core samples it. */
import { expect, test } from 'vitest';
import { dabAt, MOST_DABS, writeDabs } from '../../src/engine/brush.js';
import { open } from './engine.js';

const SETTINGS = { radius_share: 0.015 };

test('particles are finer and coarser where that is painted, by the radius and by a count, and a link keeps it', async () => {
  const p = await open();
  const { engine } = p;
  /** The smallest and the largest radius near the top and near the bottom. @param {number} sign */
  const sizesAt = (sign) => {
    const { count, positions, radii } = engine.columns;
    const near = Array.from({ length: count }, (_, i) => i).filter((i) => sign * positions[3 * i + 2] > 0.95);
    return near.map((i) => radii[i]);
  };
  await p.set({ surface: 'sphere', settings: SETTINGS });
  const plain = engine.columns.count;
  const [usual] = engine.columns.radii;
  const [top, bottom] = [dabAt([0, 0, 1], 1.2, 0.5), dabAt([0, 0, -1], 1.2, 2)];
  const brush = writeDabs([top, bottom]);
  await p.set({ settings: { ...SETTINGS, brush } });
  for (const radius of sizesAt(1)) expect(radius / usual).toBeCloseTo(0.5, 2);
  for (const radius of sizesAt(-1)) expect(radius / usual).toBeCloseTo(2, 1);
  expect(engine.columns.record?.spacing?.formula).toContain('dab2');
  const link = await engine.link();

  await p.set({ settings: { size_mode: 'count', count: 3000, brush } });
  expect(Math.abs(engine.columns.count - 3000)).toBeLessThan(90);
  expect(Math.max(...sizesAt(-1)) / Math.min(...sizesAt(1))).toBeCloseTo(4, 0);

  // Sizes by the curvature are not painted.
  await p.set({ settings: { sampling: 'adaptive', brush } });
  expect(engine.columns.record?.spacing).toBeUndefined();

  await p.set({ settings: SETTINGS });
  expect(engine.columns.count).toBe(plain);
  await p.set({ settings: { ...SETTINGS, brush: writeDabs(Array.from({ length: MOST_DABS }, () => top)) } });
  expect(engine.notice.value).toBeNull();

  await engine.openLink(link);
  expect(engine.state.value.settings.brush).toBe(brush);
});
