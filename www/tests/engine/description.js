/** A description as the core gives it, cut down to what the engine's tests need. */

/** @type {import('../../src/engine/types.js').Description} */
export const description = {
  version: '0.1.0',
  default_surface: 'ellipsoid',
  surfaces: [
    {
      id: 'ellipsoid', name: 'Ellipsoid', formula: '(x/a)^2 + (y/b)^2 + (z/c)^2 = 1',
      parameters: [{ name: 'a', label: 'a', value: 1, min: 0.2, max: 2, step: 0.01 }],
      bounds: { min: [-1.2, -1.2, -1.2], max: [1.2, 1.2, 1.2] }, degree: 2, genus: 0, story: '', mathml: '',
    },
    {
      id: 'torus', name: 'Torus', formula: '(sqrt(x^2+y^2) - R)^2 + z^2 = r^2', parameters: [],
      bounds: { min: [-2, -2, -1], max: [2, 2, 1] }, degree: 4, genus: 1, story: '', mathml: '',
    },
  ],
  models: [{ id: 'bunny', name: 'Bunny', story: '', credit: 'Stanford', points: 200 }],
  settings: [
    { name: 'size_mode', label: 'Size', group: 'size', kind: 'choice', default: 'radius', min: 0, max: 0, step: 0, scale: 'linear', unit: '', choices: [{ value: 'radius', label: 'Radius' }, { value: 'count', label: 'Count' }], help: '' },
    { name: 'radius_share', label: 'Radius', group: 'size', kind: 'number', default: 0.006, min: 0.0005, max: 0.1, step: 0.0001, scale: 'log', unit: '', help: '' },
    { name: 'count', label: 'Count', group: 'size', kind: 'integer', default: 10_000, min: 10, max: 1_000_000, step: 1, scale: 'log', unit: '', help: '' },
    { name: 'relax_steps', label: 'Steps', group: 'relaxation', kind: 'integer', default: 10, min: 0, max: 1000, step: 1, scale: 'linear', unit: '', help: '' },
    { name: 'max_particles', label: 'Limit', group: 'size', kind: 'integer', default: 200_000, min: 1, max: 4_000_000, step: 1, scale: 'log', unit: '', help: '' },
  ],
  report: [], fates: [], functions: [], colours: [], later: { functions: [], surfaces: [] },
};
