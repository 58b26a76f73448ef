/** The three figures by which samplings are judged, in a patch of a run before its relaxation. */
import { label, line, ring } from '../../figures/svg.js';
import { h, s } from '../../ui/dom.js';
import { formatFixed } from '../../ui/format.js';
import { NoSurface } from '../lab.js';
import { createMarkKey } from '../marks.js';
import { facts } from '../parts.js';
import { HALF, patchOf } from '../patch.js';
import { scoreAtEnd } from '../score.js';
import { written } from '../verdict.js';

/** @import { Context } from '../types.js' */

/** @param {Context} context */
export async function measures({ lab }) {
  const run = await (await lab).run({ relax_steps: 0 });
  const score = await scoreAtEnd(run);
  const patch = patchOf(run, score);
  if (!patch) throw new NoSurface('The surface leaves no hole that can be measured.');
  const { width, height } = HALF;
  const svg = s('svg', {
    class: 'drawing patch',
    viewBox: `${-width} ${-height} ${2 * width} ${2 * height}`,
    role: 'img',
    'aria-label': `A patch of the sampling with the cells of its particles, those with five and with seven neighbours marked. The largest empty circle has the radius ${formatFixed(patch.hole, 2)} r.`,
  });
  for (const { at, cell, valence } of patch.seen) {
    const kind = valence === 6 || valence === 0 ? '' : valence < 6 ? ' five' : ' seven';
    svg.append(ring(`disc${kind}`, at, 1), line('cell', [...cell, cell[0]]));
  }
  for (const { at } of patch.seen) svg.append(ring('centre', at, 0.1));
  svg.append(ring('hole', [0, 0], patch.hole), line('pair', patch.pair));
  const [[x, y], [u, v]] = patch.pair;
  svg.append(label('name', [0, 0], 'hole'), label('name', [(x + u) / 2 + 0.7, (y + v) / 2 - 0.1], 'pair'));
  const side = h(
    'div',
    { class: 'side' },
    createMarkKey(),
    h('p', null, 'Of the whole sampling:'),
    facts([
      ['Six neighbours', written('six', score)],
      ['Largest hole, over the ideal', written('hole', score)],
      ['Closest pair, over the ideal', written('pair', score)],
    ]),
  );
  return [h('div', { class: 'two' }, h('div', { class: 'drawing-box' }, svg), side)];
}
