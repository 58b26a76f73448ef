/** A description as the core gives it, cut down to what the engine's tests need. */

/** @import { Description, SettingInfo } from '../../../src/engine/types.js' */

/**
 * @typedef {Description['columns'][number]} Column
 */

/** @param {string} name @param {Partial<SettingInfo>} change @returns {SettingInfo} */
const setting = (name, change) => ({
  name,
  label: name,
  help: '',
  group: 'Sampling',
  kind: 'integer',
  default: 0,
  min: 0,
  max: 0,
  step: 0,
  scale: 'linear',
  unit: '',
  choices: [],
  when: [],
  ...change,
});

/** @param {string} name @param {Column['kind']} kind @returns {Column} */
const column = (name, kind) => ({ name, kind });

/** @type {Description} */
export const description = {
  version: '0.1.0',
  surfaces: [
    {
      id: 'ellipsoid',
      name: 'Ellipsoid',
      formula: '(x/a)^2 + (y/b)^2 + (z/c)^2 = 1',
      parameters: [{ name: 'a', label: 'a', value: 1, min: 0.2, max: 2, step: 0.01 }],
      bounds: { min: [-1.2, -1.2, -1.2], max: [1.2, 1.2, 1.2] },
      degree: 2,
      genus: 0,
      story: '',
      source: '',
      words: '',
      group: 'Closed',
    },
    {
      id: 'torus',
      name: 'Torus',
      formula: '(sqrt(x^2+y^2) - R)^2 + z^2 = r^2',
      parameters: [],
      bounds: { min: [-2, -2, -1], max: [2, 2, 1] },
      degree: 4,
      genus: 1,
      story: '',
      source: '',
      words: '',
      group: 'Closed',
    },
  ],
  models: [{ id: 'bunny', name: 'Bunny', story: '', credit: 'Stanford', points: 200 }],
  settings: [
    setting('size_mode', {
      kind: 'choice',
      default: 'radius',
      choices: [
        { value: 'radius', label: 'Radius' },
        { value: 'count', label: 'Count' },
      ],
    }),
    setting('radius_share', { kind: 'number', default: 0.006, min: 0.0005, max: 0.1, step: 0.0001, scale: 'log' }),
    setting('count', { default: 10_000, min: 10, max: 1_000_000, step: 1, scale: 'log' }),
    setting('relax_steps', { default: 10, max: 1000, step: 1 }),
    setting('max_particles', { default: 200_000, min: 1, max: 4_000_000, step: 1, scale: 'log' }),
  ],
  report: [],
  fates: [],
  functions: [],
  colours: [],
  columns: [
    ...['x', 'y', 'z'].map((name) => column(name, 'coordinate')),
    ...['nx', 'ny', 'nz', 'radius'].map((name) => column(name, 'float')),
    column('level', 'uint'),
    column('parent', 'int'),
    column('valence', 'uchar'),
    column('nearest', 'float'),
    column('residual', 'float'),
    column('singular', 'uchar'),
    column('patch', 'uint'),
    column('particle', 'uint'),
    column('periodic', 'uint'),
  ],
  vertices: [{ value: 'joined', label: 'Joined', help: '', formats: ['glb', 'obj', 'ply'] }],
  new_parameter: { name: '', label: '', value: 1, min: 0, max: 3, step: 0.01 },
  limits: {
    formula_bytes: 4096,
    name_pattern: '^[A-Za-z][A-Za-z0-9_]*$',
    diagonal_min: 1e-12,
    diagonal_max: 1e12,
    farthest_corner: 1e3,
    count_room: 1.1,
    centres_min: 100,
    centres_max: 800,
    centres: 200,
    file_bytes: 50_000_000,
  },
};
