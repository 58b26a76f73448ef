/** A thickness that is a formula: what is refused, and what the core samples. */
import { expect, test } from 'vitest';
import { validSetting } from '../../src/engine/share/state.js';
import { keptOf } from '../../src/ui/kept.js';
import { open, until } from './engine.js';

test('a thickness is a number or a formula of the present surface', async () => {
  const p = await open();
  const { engine } = p;
  const settings = { radius_share: 0.03 };
  await p.set({ surface: 'gyroid', settings });
  const { value: description } = engine.description;
  if (!description) throw new Error('the core has described itself');
  expect(['0.3 + 0.03z', 0.2, -1, ' ', 'z'.repeat(5000)].map((v) => validSetting(description, 'thickness', v))).toEqual(
    ['0.3 + 0.03z', 0.2, 0, undefined, undefined],
  );
  expect(validSetting(description, 'radius_share', '0.3 + z')).toBeUndefined();
  expect(await engine.textFault('thickness', '0.3 + 0.03z + 0.1t')).toBeNull();
  expect(await engine.textFault('thickness', '0.3 + 0.03q')).toContain('Thickness: The formula has no parameter `q`');
  await p.set({ settings: { ...settings, thickness: '1 + 0.1z', box_faces: 'closed' } });
  expect(engine.columns.record?.solid.thickness).toBe('1 + 0.1z');
  expect(keptOf(engine)[0].text).toBe('Thickness 1 + 0.1z');
  // Below the walls are thin, above they are thick: more of the closed box is inside.
  const { count, positions } = engine.columns;
  const top = Array.from({ length: count }, (_, i) => positions[3 * i + 2]).filter((z) => Math.abs(z - 6.2) < 1e-3);
  expect(top.length).toBeGreaterThan(20);
  // Another formula may not have the name.
  await p.set({ settings: { ...settings, thickness: '0.3 + 0.1t' } });
  engine.setFormula('sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x)');
  await until(engine.status, (status) => status !== 'sampling');
  expect(engine.notice.value).toMatchObject({ kind: 'error', text: expect.stringContaining('no parameter `t`') });
});
