/** The choices of the method that the cards show side by side, apart from those of *What if*. */
import { adaptiveRun, LAWS } from './adaptive.js';
import { knobSide, USUAL } from './knobs.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { Lab, WhatIf } from './types.js'
 */

/**
 * Two values of a setting, as sides.
 * @template {keyof LessonSettings} K
 * @param {K} key
 * @param {readonly (readonly [LessonSettings[K], string])[]} pairs  values and labels
 * @param {Partial<LessonSettings>} [others]
 */
const setting = (key, pairs, others = {}) =>
  pairs.map(([value, label]) => ({ label, make: (/** @type {Lab} */ lab) => lab.run({ [key]: value, ...others }) }));

const UNRELAXED = { relax_steps: 0 };

/** A surface with so much curvature within 2r that the projection matters. @type {FormulaSurface} */
export const TANGLECUBE = {
  formula: 'x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8 = 0',
  parameters: [],
  bounds: { min: [-3, -3, -3], max: [3, 3, 3] },
};
/** Number of particles on it. */
const FEW = 400;

/**
 * A run on the tanglecube before relaxation, with the same number of particles for every projection.
 * @param {Lab} lab @param {LessonSettings['projection']} projection
 */
export async function projected(lab, projection) {
  const own = lab.on(TANGLECUBE);
  const circle = await own.run(UNRELAXED, { particles: FEW });
  return projection === 'circle' ? circle : own.runAsMany({ projection, ...UNRELAXED }, circle);
}

/** By its name. @type {Record<string, WhatIf>} */
export const WHAT_IFS = {
  order: {
    look: 'Which particle comes next decides whether the front grows in rings or runs off like a thread, and so how many seams it leaves.',
    colouring: 'level',
    sides: setting('order', [
      ['queue', 'Queue'],
      ['stack', 'Stack'],
    ]),
  },
  projection: {
    look: 'A tanglecube, a cube with a tunnel through each pair of faces, before relaxation: it bends much within 2r. With one r Newton’s method would place more particles, since its children land nearer; so its r is larger here, and the numbers differ by 2 %.',
    colouring: 'parent',
    sides: [
      { label: 'Circle', make: (lab) => projected(lab, 'circle') },
      { label: 'Newton’s method', make: (lab) => projected(lab, 'newton') },
    ],
  },
  step: {
    look: 'How far a particle moves for the push it feels. Ten steps of either size end alike but for chance.',
    colouring: 'nearest',
    sides: setting('step_size', [
      [0.6, '0.6 r²'],
      [0.2, '0.2 r²'],
    ]),
  },
  matched: {
    look: 'The paper takes a matched particle out of the neighbours. Two children of one parent can then not be matched with the same particle, and one of them is added beside it.',
    colouring: 'nearest',
    sides: setting(
      'matched',
      [
        ['stay', 'They stay'],
        ['leave', 'They leave'],
      ],
      UNRELAXED,
    ),
  },
  gaps: {
    look: 'A hole that is wide enough for a particle can be given one before the relaxation.',
    colouring: 'nearest',
    sides: setting('gaps', [
      ['leave', 'Left open'],
      ['fill', 'Filled'],
    ]),
  },
  start: {
    decides: 'evaluations',
    look: 'The pictures agree. Look at the evaluations: a start where the parent’s curvature expects the surface needs fewer steps.',
    colouring: 'level',
    sides: setting(
      'start',
      [
        ['tangent', 'In the tangent plane'],
        ['curvature', 'Where the curvature points'],
      ],
      UNRELAXED,
    ),
  },
  placing: {
    decides: 'evaluations',
    look: 'Placing a whole level at once gives nearly the same particles. It compares children before it projects them, and so needs far fewer evaluations.',
    colouring: 'level',
    sides: setting(
      'placing',
      [
        ['one_by_one', 'Child by child'],
        ['level_by_level', 'Level by level'],
      ],
      UNRELAXED,
    ),
  },
  law: {
    look: 'Where the two curvatures have opposite signs their sum is small, and the paper’s law gives large particles there.',
    colouring: 'radius',
    sides: LAWS.slice(0, 2).map(({ value, label }) => ({ label, make: (lab) => adaptiveRun(lab, value) })),
  },
  fit: {
    look: 'A child is added if enough of the angle that it takes is free. Asking for all of it places fewer particles, which keep their distance, and leaves wider gaps for the relaxation.',
    colouring: 'nearest',
    sides: /** @type {const} */ ([
      [0.5, 'Half of it'],
      [1, 'All of it'],
    ]).map(([fit, label]) => ({ label, make: (lab) => adaptiveRun(lab, 'max_curvature', { fit, ...UNRELAXED }) })),
  },
};

/** What is to be seen where choices of *What if* differ. @type {Omit<WhatIf, 'sides'>} */
export const OF_KNOBS = {
  look: 'A dark particle is too near to another. Where the body shows between discs, a hole is open.',
  colouring: 'nearest',
};

/** The sampling of the lesson beside one with other choices. @param {string} value @returns {WhatIf} */
export const knobsAgainst = (value) => ({ ...OF_KNOBS, sides: [USUAL, value].map(knobSide) });
