/** Particles whose size follows the curvature. */
import { signal } from '@preact/signals-core';
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
  const law = signal(/** @type {Law} */ ('max_curvature'));
  async function show(/** @type {Law} */ wanted) {
    law.value = wanted;
    const run = await adaptiveRun(own, wanted);
    if (!picture.scene.peek()) {
      orbit.fitTo(run.end);
      orbit.faceFront(run.end);
    }
    const { radii } = run.end;
    const [low, high] = [Math.min(...radii), Math.max(...radii)];
    picture.show({ particles: run.end, colours: byValue(radii, low, high) });
    fill(legend, createScale('Radius', formatSignificant(low, 2), formatSignificant(high, 2)));
    words.textContent = `${plural(radii.length, 'particle')}. As many of one size have the radius ${formatSignificant(radius, 2)}.`;
  }
  await show(law.peek());
  // The answer concerns the smallest discs.
  live(words, () => {
    const { radii, normals } = picture.scene.peek()?.particles ?? {};
    if (!stops.isOpen('predict-sizes') || !radii || !normals) return;
    orbit.turnTo(triple(normals, radii.indexOf(Math.min(...radii))));
  });
  const choice = createSelectRow({
    name: 'The radius follows',
    choices: () => LAWS,
    value: () => law.value,
    change: (value) => void show(value),
  });
  return [picture.element, h('div', { class: 'controls' }, choice, words), legend];
}
