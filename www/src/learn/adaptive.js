/** Runs of adaptive sampling, scaled to about as many particles as the other runs have. */
import { PARTICLES } from './lab.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { Lab, LabRun, Law } from './types.js'
 */

/** The laws, with their labels. @type {readonly { value: Law, label: string }[]} */
export const LAWS = [
  { value: 'sum_of_curvatures', label: 'Sum of the curvatures, as in the paper' },
  { value: 'max_curvature', label: 'The stronger curvature' },
  { value: 'chord_error', label: 'Gap between surface and mesh' },
];
/** Smallest and largest radius, divided by that of uniform sampling with as many particles. */
const [LEAST, LARGEST] = [0.5, 2.2];
const MOST_TRIALS = 4;
const CLOSE = 0.15;

/** @type {WeakMap<Lab, Map<string, Promise<LabRun>>>} */
const found = new WeakMap();

/**
 * Returns an adaptive run for a law, scaled to about as many particles as the other runs have.
 * @param {Lab} lab @param {Law} law @param {Partial<LessonSettings>} [change]
 * @param {number} [particles]
 */
export function adaptiveRun(lab, law, change = {}, particles = PARTICLES) {
  const runs = found.get(lab) ?? new Map();
  found.set(lab, runs);
  const key = JSON.stringify([law, change, particles]);
  const run = runs.get(key) ?? scaled(lab, law, change, particles);
  runs.set(key, run);
  return run;
}

/** @param {Lab} lab @param {Law} law @param {Partial<LessonSettings>} change @param {number} particles */
async function scaled(lab, law, change, particles) {
  const radius = await lab.radiusFor(particles);
  // The gap is a length of second order in the radius; the other laws scale with a pure number.
  const coarseness = Math.sqrt(PARTICLES / particles);
  let scale = law === 'chord_error' ? 0.3 * radius * LEAST : 0.12 * coarseness;
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
    const ratio = run.progress.particles / particles;
    if (Math.abs(ratio - 1) < CLOSE || trial === MOST_TRIALS)
      return lab.run({ ...settings, relax_steps: 10, ...change });
    scale *= ratio ** power;
  }
}
