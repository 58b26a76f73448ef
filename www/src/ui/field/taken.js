/** The choice whether a mesh file is treated as a surface or as points. */
import { FILE_SURFACE } from '../../engine/constants.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { createSegmented } from '../segmented.js';

/** @import { Engine } from '../../engine/types.js' */

/** @param {Engine} engine */
export function createTaken(engine) {
  const choice = createSegmented({
    name: 'The file is taken for',
    choices: [
      { value: 'surface', label: 'Surface' },
      { value: 'points', label: 'Points' },
    ],
    value: () => engine.taken.value ?? 'surface',
    change: (value) => engine.takeFileFor(value === 'points' ? 'points' : 'surface'),
  });
  explain(choice, () => ({
    title: 'Surface or points',
    text: 'The faces are the surface, which is sampled anew with its sharp edges. Or a smooth surface is fitted to the vertices, which rounds edges and averages noise away.',
  }));
  const hidden = () => engine.taken.value === null || engine.state.value.surface !== FILE_SURFACE;
  return h('div', { class: 'chosen', hidden }, choice);
}
