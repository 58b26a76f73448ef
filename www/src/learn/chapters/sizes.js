/** Particles as small as the curvature asks for. */
import { effect } from '@preact/signals-core';
import { fill, h } from '../../ui/dom.js';
import { formatSignificant, plural } from '../../ui/format.js';
import { PARTICLES } from '../lab.js';
import { createScale, createSelect } from '../parts.js';
import { byValue, Orbit, Picture } from '../picture.js';

/**
 * @typedef {import('./index.js').Context} Context
 * @typedef {import('../lab.js').Lab} Lab
 * @typedef {import('../../engine/lesson/protocol.js').LessonSettings['law']} Law
 */

/** The laws in words. @type {readonly { value: Law, label: string }[]} */
export const LAWS = [
  { value: 'sum_of_curvatures', label: 'Sum of the curvatures, as in the paper' },
  { value: 'max_curvature', label: 'The stronger curvature' },
  { value: 'chord_error', label: 'Gap to the triangles' },
];
/** Least and largest radius, over that of even sampling with as many particles. */
const [LEAST, LARGEST] = [0.5, 2.2];
const MOST_TRIALS = 4;
const CLOSE = 0.15;

/** @type {WeakMap<Lab, Map<string, Promise<import('../lab.js').Run>>>} */
const found = new WeakMap();

/**
 * Returns an adaptive run by a law, scaled so that it has about as many particles as the others.
 * @param {Lab} lab @param {Law} law @param {Partial<import('../../engine/lesson/protocol.js').LessonSettings>} [change]
 */
export function adaptiveRun(lab, law, change = {}) {
  const runs = found.get(lab) ?? new Map();
  found.set(lab, runs);
  const key = JSON.stringify([law, change]);
  const run = runs.get(key) ?? scaled(lab, law, change);
  runs.set(key, run);
  return run;
}

/** @param {Lab} lab @param {Law} law @param {Partial<import('../../engine/lesson/protocol.js').LessonSettings>} change */
async function scaled(lab, law, change) {
  const radius = await lab.radiusFor(PARTICLES);
  // The gap is a length, of the second order in the radius; the other laws scale with a pure number.
  let scale = law === 'chord_error' ? 0.3 * radius * LEAST : 0.12;
  const power = law === 'chord_error' ? 1 : 0.5;
  for (let trial = 1; ; trial += 1) {
    const settings = /** @type {const} */ ({
      sampling: 'adaptive',
      law,
      law_scale: scale,
      radius_min: LEAST * radius,
      radius_max: LARGEST * radius,
      relax_steps: 0,
    });
    const run = await lab.run(settings);
    const ratio = run.progress.particles / PARTICLES;
    if (Math.abs(ratio - 1) < CLOSE || trial === MOST_TRIALS)
      return lab.run({ ...settings, relax_steps: 10, ...change });
    scale *= ratio ** power;
  }
}

/** @param {Context} context */
export async function sizes({ lab, stops }) {
  const own = await lab;
  const radius = await own.radiusFor(PARTICLES);
  const orbit = new Orbit(own.surface.bounds);
  const picture = new Picture(orbit, {
    name: 'Particles of sizes that follow the curvature, coloured by their radius',
  });
  const words = h('p', { class: 'figure-count' });
  const legend = h('div');
  let isFirst = true;
  const show = async (/** @type {Law} */ law) => {
    const run = await adaptiveRun(own, law);
    if (isFirst) orbit.fitTo(run.end);
    isFirst = false;
    const { radii } = run.end;
    const [low, high] = [Math.min(...radii), Math.max(...radii)];
    picture.show({ particles: run.end, colours: byValue(radii, low, high) });
    fill(legend, createScale('Radius', formatSignificant(low, 2), formatSignificant(high, 2)));
    words.textContent = `${plural(radii.length, 'particle')}; even sampling with as many has the radius ${formatSignificant(radius, 2)}.`;
  };
  const law = createSelect({
    name: 'The radius follows',
    choices: LAWS,
    value: 'max_curvature',
    change: (value) => void show(/** @type {Law} */ (value)),
  });
  await show('max_curvature');
  effect(() => {
    words.hidden = !stops.isOpen('predict-sizes');
  });
  return [picture.element, h('div', { class: 'controls' }, law.element, words), legend];
}
