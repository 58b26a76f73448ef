/** The choices of the method that can be seen side by side. */
import { adaptiveRun, LAWS } from './adaptive.js';

/**
 * @import { LessonSettings } from '../engine/lesson/types.js'
 * @import { Lab, Setup, Side, WhatIf } from './types.js'
 */

/**
 * Runs whose particles are counted and drawn, and not asked for events.
 * @param {(value: string) => Partial<LessonSettings>} settings
 */
const even = (settings) => (/** @type {Lab} */ lab, /** @type {string} */ value) => lab.run(settings(value));

/** The value of a seed that was pressed is this and its place. */
const AT = 'at ';

/** @param {readonly number[]} place */
export const seedAt = (place) => AT + place.map((v) => Number(v.toPrecision(4))).join(' ');

/** @param {string} value */
const isPlace = (value) => value.startsWith(AT) && parsePlace(value).every(Number.isFinite);

/** Whether a choice has a value, which may be anything. @param {WhatIf} whatIf @param {unknown} value */
const hasValue = ({ id, values: all }, value) =>
  all.some((known) => known.value === value) || (id === 'seed' && typeof value === 'string' && isPlace(value));

/** @param {string} value @returns {[number, number, number]} */
function parsePlace(value) {
  const [x, y, z] = value.slice(AT.length).split(' ').map(Number);
  return [x, y, z];
}

/** @param {readonly (readonly [string, string])[]} pairs */
const values = (pairs) => pairs.map(([value, label]) => ({ value, label }));

/**
 * The values and the runs of a choice that is one setting.
 * @template {keyof LessonSettings} K
 * @param {K} key
 * @param {readonly (readonly [string & LessonSettings[K], string])[]} pairs
 * @param {Partial<LessonSettings>} [others]
 */
const setting = (key, pairs, others) => ({
  values: values(pairs),
  make: even((value) => ({ [key]: value, ...others })),
});

const ONE_SIZE = 'one_size';

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
    id: 'projection',
    name: 'Circle or Newton',
    look: 'The distance of each child to its parent. The circle keeps 2r everywhere; Newton’s method falls short of it where the surface bends.',
    colouring: 'parent',
    ...setting(
      'projection',
      [
        ['circle', 'Circle'],
        ['newton', 'Newton’s method'],
      ],
      { relax_steps: 0 },
    ),
  },
  {
    id: 'tolerance',
    name: 'Match tolerance',
    look: 'How near a particle has to be to count as the child. Too small, and particles crowd along the seams; too large, and holes stay open.',
    colouring: 'nearest',
    values: values([
      ['0.7', '0.7 · 2r'],
      ['0.4', '0.4 · 2r'],
      ['0.55', '0.55 · 2r'],
      ['0.85', '0.85 · 2r'],
      ['0.95', '0.95 · 2r'],
    ]),
    make: even((tolerance) => ({ match_tolerance: Number(tolerance), relax_steps: 0 })),
  },
  {
    id: 'seed',
    name: 'Another seed',
    look: 'Where the front begins moves the rings and the seams. The number of particles and the spacing hardly change. Press a particle of a picture to begin there.',
    colouring: 'level',
    values: values([
      ['0', 'Seed 0'],
      ['1', 'Seed 1'],
      ['2', 'Seed 2'],
      ['3', 'Seed 3'],
    ]),
    make: even((seed) => (isPlace(seed) ? { seeds: [parsePlace(seed)] } : { seed: Number(seed) })),
  },
  {
    id: 'steps',
    name: 'Steps of relaxation',
    look: 'Ten steps close most of the holes. Ninety more change little that one can see.',
    colouring: 'nearest',
    values: values([
      ['0', 'None'],
      ['10', 'Ten steps'],
      ['100', 'A hundred steps'],
    ]),
    make: even((steps) => ({ relax_steps: Number(steps) })),
  },
  {
    id: 'step',
    name: 'Size of a step',
    look: 'How far a particle moves for the push it feels. Ten short steps leave seams that ten long ones close.',
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
    name: 'Laws of the radius',
    look: 'Where the two curvatures have opposite signs their sum is small, and the paper’s law gives large particles there. With one size for all, small particles are spent on flat places.',
    colouring: 'radius',
    values: [...LAWS, { value: ONE_SIZE, label: 'One size for all' }],
    make: (lab, law) => (law === ONE_SIZE ? lab.run({}) : adaptiveRun(lab, /** @type {LessonSettings['law']} */ (law))),
  },
  {
    id: 'fit',
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

/** @param {WhatIf} whatIf @param {readonly [string, string]} chosen @returns {[Side, Side]} */
export function sidesOf({ values: all, make }, [left, right]) {
  /** @param {string} value @returns {Side} */
  const side = (value) => ({
    label: all.find((known) => known.value === value)?.label ?? value,
    make: (lab) => make(lab, value),
  });
  return [side(left), side(right)];
}

/** The choice of this name, else the first. @param {string} id */
export const whatIfOf = (id) => WHAT_IFS.find((whatIf) => whatIf.id === id) ?? WHAT_IFS[0];

/**
 * The setup of a choice with the values that are given, and those that are first shown where there is none of its own.
 * @param {string} id @param {{ left?: unknown, right?: unknown }} [given]
 * @returns {Setup}
 */
export function setupOf(id, given = {}) {
  const whatIf = whatIfOf(id);
  const [left, right] = [given.left, given.right].map((value, k) =>
    hasValue(whatIf, value) ? String(value) : whatIf.values[k].value,
  );
  return { what: whatIf.id, left, right };
}
