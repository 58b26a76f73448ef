/** Every setting and what else a surface can be given, against another surface: what stays and what begins afresh. */
import { expect, test } from 'vitest';
import { TYPING_MS } from '../../src/engine/constants.js';
import { createHistory } from '../../src/ui/history.js';
import { keptOf } from '../../src/ui/kept.js';
import { open, turn, until } from './engine.js';

/** @import { SettingInfo } from '../../src/engine/types.js' */

/** A value that a setting does not have of itself; a length without ends is a tenth. @param {SettingInfo} info */
const otherOf = ({ kind, choices, default: own, min, max }) =>
  kind === 'text'
    ? '0.1 + 0.02z'
    : choices?.length
      ? choices.find(({ value }) => value !== own)?.value
      : ((own === max ? min : max) ?? 0.1);

/** What belongs to the surface it was chosen for. Every other setting is of the way of sampling, and stays. */
const OF_SURFACE = ['beyond_points', 'box_cell', 'box_faces', 'box_mode', 'spacing', 'thickness'];

test('of all settings, those of a surface end with it, and a changed formula keeps them', async () => {
  const p = await open();
  const { engine } = p;
  const settings = engine.description.value?.settings ?? [];
  expect(settings.length).toBeGreaterThan(10);
  const table = settings.map((info) => {
    const { name } = info;
    const isThere = () => name in engine.state.value.settings;
    const value = otherOf(info);
    if (value === undefined) throw new Error(`${name} has one value only`);
    engine.setSurface('ellipsoid');
    engine.setSetting(name, value);
    const row = [name, isThere()];
    engine.setFormula('x^2 + y^2 + 2z^2 = 1');
    row.push(isThere());
    engine.setSurface('torus');
    row.push(isThere());
    engine.resetSetting(name);
    return row;
  });
  engine.stop();
  expect(table).toEqual(settings.map(({ name }) => [name, true, true, !OF_SURFACE.includes(name)]));
});

test('what of a surface stays with a changed formula is told, with the button that ends it', async () => {
  const p = await open();
  const { engine } = p;
  engine.setSurface('ellipsoid');
  expect(keptOf(engine)).toEqual([]);
  engine.setPlane({ normal: [1, 0, 0], offset: 0 });
  engine.setBounds({ min: [-1, -1, -1], max: [1, 1, 0.2] });
  const chosen = {
    box_cell: 'periodic',
    box_faces: 'closed',
    box_mode: 'fixed',
    spacing: '0.1 + 0.02z',
    thickness: 0.1,
  };
  // Where a model ends is no matter of a formula.
  expect(['beyond_points', ...Object.keys(chosen)]).toEqual(OF_SURFACE);
  for (const [name, value] of Object.entries(chosen)) engine.setSetting(name, value);
  engine.setFormula('x^2 + y^2 + 2z^2 = 1');
  expect(keptOf(engine).map(({ text }) => text.replace(/,.*/, ''))).toEqual([
    'Cut at x = 0',
    'Thickness 0.1',
    'Spacing 0.1 + 0.02z',
    'Closed by the box',
    'Opposite faces alike',
    'Box set by hand',
  ]);
  // From the last on, since a cell is told only of a solid that the box closes.
  for (const { act } of keptOf(engine).reverse()) act();
  expect(keptOf(engine)).toEqual([]);
  engine.stop();
  expect(p.state).toMatchObject({ plane: null, bounds: null, settings: {} });
});

test('plane, box, parameters and the place on the timeline end with their surface; how it is drawn stays', async () => {
  const p = await open();
  const { engine } = p;
  engine.setPlane({ normal: [1, 0, 0], offset: 0 });
  engine.setBounds({ min: [-1, -1, -1], max: [1, 1, 0.2] });
  engine.setParameter('a', 0.8);
  const drawn = /** @type {const} */ ({ draw: 'spheres', size: 0.7, axes: true, box: true, colour: 'plain' });
  engine.setView({ ...drawn, level: 3 });
  engine.setSurface('torus');
  engine.stop();
  expect(p.state).toMatchObject({
    surface: 'torus',
    plane: null,
    bounds: null,
    parameters: {},
    declared: [],
    pulls: [],
  });
  expect(p.state.view).toMatchObject({ ...drawn, level: null, step: null });
});

test('a formula put in the place of another as a whole ends what was set for that; one that is typed does not', async () => {
  const p = await open();
  const { engine } = p;
  const give = () => {
    engine.setSurface('gyroid');
    for (const [name, value] of Object.entries({ box_faces: 'closed', thickness: 0.3, relax_steps: 5 }))
      engine.setSetting(name, value);
    engine.setBounds({ min: [-4, -4, -4], max: [4, 4, 4] });
    engine.setPlane({ normal: [1, 0, 0], offset: 0 });
    engine.setParameter('t', 0.2);
  };
  const nut = 'max(abs(x), abs(y), abs(z)) - 1 + t';
  give();
  engine.setFormula(nut, { typing: true });
  expect(keptOf(engine)).toHaveLength(4);
  give();
  engine.setFormula(nut, { typing: true, whole: true });
  expect(keptOf(engine)).toEqual([]);
  expect(p.state).toMatchObject({
    formula: nut,
    plane: null,
    bounds: null,
    parameters: {},
    settings: { relax_steps: 5 },
  });
  engine.stop();
});

test('one step back leads to the surface before, with all that was set for it, though the camera has turned', async () => {
  const p = await open();
  const { engine, debug } = p;
  const history = createHistory(engine, engine.dragging);
  await p.set({ surface: 'gyroid', settings: { radius_share: 0.06, thickness: 0.4, box_faces: 'closed' } });
  engine.lookFrom('front');
  await debug.still();
  const before = p.state;
  engine.setFormula('9x^2 + y^2 + 4z^2 = 1', { typing: true, whole: true });
  turn(TYPING_MS);
  await until(engine.turned, (times) => times > 0);
  await debug.still();
  expect(p.state.view.camera.yaw).not.toBe(before.view.camera.yaw);
  history.undo();
  const { surface, formula, settings, view } = p.state;
  expect([surface, formula, settings]).toEqual([before.surface, before.formula, before.settings]);
  expect(view.camera).toEqual(before.view.camera);
  engine.stop();
});
