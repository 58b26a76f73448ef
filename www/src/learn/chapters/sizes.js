/** Particles whose size follows the curvature. */
import { triple } from '../../engine/vector.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatSignificant, plural } from '../../ui/format.js';
import { adaptiveRun, LAWS } from '../adaptive.js';
import { PARTICLES } from '../lab.js';
import { createScale, createSelectRow } from '../parts.js';
import { byValue, Orbit, Picture } from '../picture.js';

/** @import { Context, Law } from '../types.js' */

/** @param {Context} context */
export async function sizes({ lab, stops }) {
  const own = await lab;
  const radius = await own.radiusFor(PARTICLES);
  const orbit = new Orbit();
  const picture = new Picture(orbit, {
    name: 'Particles of sizes that follow the curvature, coloured by their radius',
  });
  const words = h('p', { class: 'figure-count', hidden: () => !stops.isOpen('predict-sizes') });
  const legend = h('div');
  let isFirst = true;
  const show = async (/** @type {Law} */ law) => {
    const run = await adaptiveRun(own, law);
    if (isFirst) {
      orbit.fitTo(run.end);
      orbit.faceFront(run.end);
    }
    isFirst = false;
    const { radii } = run.end;
    const [low, high] = [Math.min(...radii), Math.max(...radii)];
    picture.show({ particles: run.end, colours: byValue(radii, low, high) });
    fill(legend, createScale('Radius', formatSignificant(low, 2), formatSignificant(high, 2)));
    words.textContent = `${plural(radii.length, 'particle')}. As many of one size have the radius ${formatSignificant(radius, 2)}.`;
  };
  const law = createSelectRow({
    name: 'The radius follows',
    choices: LAWS,
    value: 'max_curvature',
    change: (value) => void show(value),
  });
  await show('max_curvature');
  // The answer concerns the smallest discs.
  live(words, () => {
    const { radii, normals } = picture.scene.peek()?.particles ?? {};
    if (!stops.isOpen('predict-sizes') || !radii || !normals) return;
    orbit.turnTo(triple(normals, radii.indexOf(Math.min(...radii))));
  });
  return [picture.element, h('div', { class: 'controls' }, law.element, words), legend];
}
