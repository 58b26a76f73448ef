/** The choices of the method that can be compared side by side. */
import { formatFixed } from '../ui/format.js';
import { adaptiveRun, LAWS } from './adaptive.js';
import { BENCH } from './address.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { Knob, Lab, Setup, Side, WhatIf } from './types.js'
 */

/**
 * Runs that are only counted and drawn, without events.
 * @param {(value: string) => Partial<LessonSettings>} settings
 */
const even = (settings) => (/** @type {Lab} */ lab, /** @type {string} */ value) => lab.run(settings(value));

/** The value of a pressed seed begins with this, followed by its coordinates. */
const AT = 'at ';

/** @param {readonly number[]} place */
export const seedAt = (place) => AT + place.map((v) => Number(v.toPrecision(4))).join(' ');

/** @param {string} value */
const isPlace = (value) => value.startsWith(AT) && parsePlace(value).every(Number.isFinite);

/** @param {string} value @returns {[number, number, number]} */
function parsePlace(value) {
  const [x, y, z] = value.slice(AT.length).split(' ').map(Number);
  return [x, y, z];
}

/** @param {readonly (readonly [string, string])[]} pairs */
const values = (pairs) => pairs.map(([value, label]) => ({ value, label }));

/**
 * The values and runs of a choice that is a single setting.
 * @template {keyof LessonSettings} K
 * @param {K} key
 * @param {readonly (readonly [string & LessonSettings[K], string])[]} pairs
 * @param {Partial<LessonSettings>} [others]
 */
const setting = (key, pairs, others) => ({
  values: values(pairs),
  make: even((value) => ({ [key]: value, ...others })),
});

/** Separates the values of knobs. */
const BETWEEN = '~';

/** The values of the knobs. @param {string} value */
export const partsOf = (value) => value.split(BETWEEN);

/** The value of knobs with one of them changed. @param {string} value @param {number} k @param {string} part */
export const turned = (value, k, part) => partsOf(value).with(k, part).join(BETWEEN);

/** Range of the tolerance, in 2r. */
export const TOLERANCES = { min: 0.4, max: 0.95, step: 0.05 };

/** A tolerance in words, in radii like every length of the lesson. @param {number} of2r */
export const toleranceWords = (of2r) => `${formatFixed(2 * of2r, 1)} r`;

/** The choices that can be combined. @type {readonly Knob[]} */
export const KNOBS = [
  {
    name: 'Who comes next',
    values: values([
      ['queue', 'Queue'],
      ['stack', 'Stack'],
    ]),
    set: (order) => ({ order: /** @type {LessonSettings['order']} */ (order) }),
    why: () =>
      'The newest particle comes next, so the front runs off like a thread. Threads meet far more often than rings do, and every meeting is a seam.',
  },
  {
    name: 'Tolerance',
    values: [],
    scale: TOLERANCES,
    set: (tolerance) => ({ match_tolerance: Number(tolerance) }),
    why: (part) =>
      Number(part) < 0.7
        ? 'Where rows meet, a particle that is off by more than this does not count as the child. A second one is put beside it, and the particles crowd.'
        : 'A child counts as matched by a particle far from its place. Nothing is put there, and the hole stays open.',
  },
  {
    name: 'Relaxation',
    values: values([
      ['10', 'Ten steps'],
      ['0', 'No steps'],
      ['100', 'A hundred steps'],
    ]),
    set: (steps) => ({ relax_steps: Number(steps) }),
    why: (part) =>
      part === '0'
        ? 'Nothing is pushed into the holes that placing leaves beside its seams.'
        : 'Pushed that long, particles go farther from where the front has put them.',
  },
  {
    name: 'Seed',
    values: values([
      ['0', 'Seed 0'],
      ['1', 'Seed 1'],
      ['2', 'Seed 2'],
      ['3', 'Seed 3'],
    ]),
    set: (seed) => (isPlace(seed) ? { seeds: [parsePlace(seed)] } : { seed: Number(seed) }),
    why: () => 'Another seed moves the rings, and the seams with them. Their number hardly changes.',
  },
];
/** Index of the tolerance's knob, and of the seed's, which also accepts a point. */
export const [TOLERANCE, SEED] = [1, 3];

/** The knobs as in the lesson. */
export const USUAL = ['queue', '0.7', '10', '0'].join(BETWEEN);

/** A value of a knob in words. @param {number} k @param {string} part */
export const partWords = (k, part) =>
  KNOBS[k].scale ? toleranceWords(Number(part)) : (KNOBS[k].values.find(({ value }) => value === part)?.label ?? part);

/** @param {number} k @param {string} part */
function isPart(k, part) {
  const { scale, values: all } = KNOBS[k];
  if (scale) return Number(part) >= scale.min && Number(part) <= scale.max;
  return all.some(({ value }) => value === part) || (k === SEED && isPlace(part));
}

/** Knobs in words. @param {string} value */
export function knobWords(value) {
  const [first, ...others] = partsOf(value).map((part, k) => partWords(k, part));
  return [first, ...others.map((words) => words.toLowerCase())].join(', ');
}

/** @param {WhatIf} whatIf @param {unknown} value */
function hasValue({ values: all, knobs }, value) {
  if (typeof value !== 'string') return false;
  if (!knobs) return all.some((known) => known.value === value);
  const parts = partsOf(value);
  return parts.length === knobs.length && parts.every((part, k) => isPart(k, part));
}

const ONE_SIZE = 'one_size';

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
 * @param {Lab} lab @param {string} projection
 */
export async function projected(lab, projection) {
  const own = lab.on(TANGLECUBE);
  const circle = await own.run({ relax_steps: 0 }, { particles: FEW });
  if (projection !== 'newton') return circle;
  return own.runAsMany({ projection, relax_steps: 0 }, circle);
}

/** The choice that has knobs. */
export const FAIL = 'fail';

/** @type {readonly WhatIf[]} */
export const WHAT_IFS = [
  {
    id: 'order',
    name: 'Queue or stack',
    look: 'Which particle comes next decides whether the front grows in rings or runs off like a thread, and so how many seams it leaves.',
    colouring: 'level',
    ...setting('order', [
      ['queue', 'Queue'],
      ['stack', 'Stack'],
    ]),
  },
  {
    id: FAIL,
    name: 'Make it fail',
    look: 'A dark particle is too near to another. Where the body shows between discs, a hole is open.',
    colouring: 'nearest',
    knobs: KNOBS,
    values: [
      USUAL,
      ...[turned(USUAL, 0, 'stack'), turned(USUAL, 1, '0.4'), turned(USUAL, 1, '0.95'), turned(USUAL, 2, '0')],
      ...[turned(USUAL, SEED, '1'), ['stack', '0.4', '0', '0'].join(BETWEEN)],
    ].map((value) => ({ value, label: knobWords(value) })),
    make: even((value) => Object.assign({}, ...partsOf(value).map((part, k) => KNOBS[k].set(part)))),
  },
  {
    id: 'projection',
    isRare: true,
    name: 'Circle or Newton',
    look: 'A tanglecube, a cube with a tunnel through each pair of faces, before relaxation: it bends much within 2r. With one r Newton’s method would place more particles, since its children land nearer; so its r is larger here, and the numbers differ by 2 %.',
    colouring: 'parent',
    values: values([
      ['circle', 'Circle'],
      ['newton', 'Newton’s method'],
    ]),
    make: projected,
  },
  {
    id: 'step',
    isRare: true,
    name: 'Size of a step',
    look: 'How far a particle moves for the push it feels. Ten steps of any of these sizes end alike but for chance.',
    colouring: 'nearest',
    values: values([
      ['0.6', '0.6 r²'],
      ['0.2', '0.2 r²'],
      ['1', '1.0 r²'],
    ]),
    make: even((size) => ({ step_size: Number(size) })),
  },
  {
    id: 'matched',
    isRare: true,
    name: 'Matched particles leave or stay',
    look: 'The paper takes a matched particle out of the neighbours. Two children of one parent can then not be matched with the same particle, and one of them is added beside it.',
    colouring: 'nearest',
    ...setting(
      'matched',
      [
        ['stay', 'They stay'],
        ['leave', 'They leave'],
      ],
      { relax_steps: 0 },
    ),
  },
  {
    id: 'gaps',
    isRare: true,
    name: 'Gaps left or filled',
    look: 'A hole that is wide enough for a particle can be given one before the relaxation.',
    colouring: 'nearest',
    ...setting('gaps', [
      ['leave', 'Left open'],
      ['fill', 'Filled'],
    ]),
  },
  {
    id: 'start',
    isRare: true,
    decides: 'evaluations',
    name: 'Where the search begins',
    look: 'The pictures agree. Look at the evaluations: a start where the parent’s curvature expects the surface needs fewer steps.',
    colouring: 'level',
    ...setting(
      'start',
      [
        ['tangent', 'In the tangent plane'],
        ['curvature', 'Where the curvature points'],
      ],
      { relax_steps: 0 },
    ),
  },
  {
    id: 'placing',
    isRare: true,
    decides: 'evaluations',
    name: 'Child by child or level by level',
    look: 'Placing a whole level at once gives nearly the same particles. It compares children before it projects them, and so needs far fewer evaluations.',
    colouring: 'level',
    ...setting(
      'placing',
      [
        ['one_by_one', 'Child by child'],
        ['level_by_level', 'Level by level'],
      ],
      { relax_steps: 0 },
    ),
  },
  {
    id: 'law',
    isRare: true,
    name: 'Laws of the radius',
    look: 'Where the two curvatures have opposite signs their sum is small, and the paper’s law gives large particles there. With one size for all, small particles are spent on flat places.',
    colouring: 'radius',
    values: [...LAWS, { value: ONE_SIZE, label: 'One size for all' }],
    make: (lab, law) => (law === ONE_SIZE ? lab.run({}) : adaptiveRun(lab, /** @type {LessonSettings['law']} */ (law))),
  },
  {
    id: 'fit',
    isRare: true,
    name: 'Room for an adaptive child',
    look: 'A child is added if enough of the angle that it takes is free. Asking for all of it places fewer particles, which keep their distance, and leaves wider gaps for the relaxation.',
    colouring: 'nearest',
    values: values([
      ['0.5', 'Half of it'],
      ['1', 'All of it'],
      ['0.75', 'Three quarters'],
    ]),
    make: (lab, fit) => adaptiveRun(lab, 'max_curvature', { fit: Number(fit), relax_steps: 0 }),
  },
];

/** The choices on the bench; the others have cards. */
export const COMMON = WHAT_IFS.filter(({ isRare }) => !isRare);

/** Stops of the bench in the address, one per choice. */
export const stopsOfBench = WHAT_IFS.map(({ id }) => `${BENCH}-${id}`);

/** @param {WhatIf} whatIf @param {readonly [string, string]} chosen @returns {[Side, Side]} */
export function sidesOf({ values: all, knobs, make }, [left, right]) {
  /** @param {string} value @returns {Side} */
  const side = (value) => ({
    label: knobs ? knobWords(value) : (all.find((known) => known.value === value)?.label ?? value),
    make: (lab) => make(lab, value),
  });
  return [side(left), side(right)];
}

/** The choice of this name, else the first. @param {string} id */
export const whatIfOf = (id) => WHAT_IFS.find((whatIf) => whatIf.id === id) ?? WHAT_IFS[0];

/**
 * The setup of a choice with the given values, and the default ones for those that are missing or invalid.
 * @param {string} id @param {{ on?: unknown, left?: unknown, right?: unknown }} [given]
 * @returns {Setup}
 */
export function setupOf(id, given = {}) {
  const whatIf = whatIfOf(id);
  const [left, right] = [given.left, given.right].map((value, k) =>
    hasValue(whatIf, value) ? String(value) : whatIf.values[k].value,
  );
  return { what: whatIf.id, on: typeof given.on === 'string' ? given.on : '', left, right };
}
