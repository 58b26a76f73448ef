/** What the first view of the lesson shows, on surfaces of the gallery. */
import { expect, test } from 'vitest';
import { LessonClient } from '../../../src/engine/lesson/client.js';
import { Meter } from '../../../src/engine/sampling/meter.js';
import { axes } from '../../../src/engine/view/camera.js';
import { anglesOf } from '../../../src/engine/view/facing.js';
import { FIRST_LEVELS, frontNormal, shareFacing } from '../../../src/learn/front.js';
import { Lab } from '../../../src/learn/lab.js';
import { Core } from '../../../src/wasm/core/core.js';
import { some } from '../../all.js';
import { loadWasm, spawn, spawnCore } from './workers.js';

/** Where five levels wind around tubes no side shows nine tenths of them: there the camera follows the front. */
const WOUND = [...['tanglecube', 'double-torus', 'decocube', 'chmutov', 'ball-lattice', 'barth-sextic', 'gyroid']];

test('nine tenths of the first levels face the viewer, unless they wind around tubes', {
  timeout: 900_000,
}, async () => {
  loadWasm();
  const open = async () => new LessonClient({ spawn });
  const meter = new Meter({ spawn: spawnCore });
  /** @type {any[]} */
  const all = new Core().describe().surfaces.filter(({ formula }) => formula);
  const isWound = (/** @type {{ id: string }} */ { id }) => WOUND.includes(id);
  expect(all.filter(isWound)).toHaveLength(WOUND.length);
  const chosen = [
    ...some(all.filter(isWound), 2),
    ...some(
      all.filter((one) => !isWound(one)),
      2,
    ),
  ];
  const wound = [];
  for (const { id, formula, parameters, bounds } of chosen) {
    const { end } = await new Lab({ formula, parameters, bounds }, open, meter).run({ relax_steps: 0 });
    const { forward } = axes(anglesOf(frontNormal(end)));
    const share = shareFacing(end, forward, 1, FIRST_LEVELS);
    expect(share, id).toBeGreaterThan(0.5);
    if (share < 0.9) wound.push(id);
  }
  expect(wound).toEqual(chosen.filter(isWound).map(({ id }) => id));
});
