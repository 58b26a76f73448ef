import { describe, expect, it } from 'vitest';
import { FILE_SURFACE } from '../../../src/engine/constants.js';
import { factsOf, fittedOf, plainOf } from '../../../src/ui/field/facts.js';
import { carriesFiles, describeLoadingError, filesOf } from '../../../src/ui/field/files.js';
import { storyOf } from '../../../src/ui/field/story.js';
import { description } from '../engine/description.js';

/** @import { ModelInfo } from '../../../src/engine/types.js' */

const info = /** @type {ModelInfo} */ ({
  name: 'dragon.ply',
  credit: '',
  points: 5205,
  centres: 400,
  condition: 1.13e7,
  residual_mean: 0.00221,
  residual_95: 0.00641,
  residual_max: 0.0134,
  farthest: [0, 0, 0],
  beyond_share: 0,
  mesh: null,
  normals: 'from_mesh',
  warnings: [],
});

describe('a file of points', () => {
  it('has its formats and its limit named', () => {
    const engine = /** @type {any} */ ({ description: { value: description } });
    expect(filesOf(engine)).toBe('PLY, OBJ, STL, OFF, GLB, 3MF, PCD, XYZ, PTS or CSV, up to 50\u202fMB');
  });

  it('is told from a drag of text', () => {
    expect(carriesFiles({ types: ['Files'] })).toBe(true);
    expect(carriesFiles({ types: ['text/plain', 'text/html'] })).toBe(false);
    expect(carriesFiles(null)).toBe(false);
  });

  it('is refused in whole sentences, with what to do', () => {
    const error = {
      id: FILE_SURFACE,
      name: 'a.xyz',
      kind: 'refused',
      message: 'line 7: the second number is missing',
    };
    expect(describeLoadingError(error)).toEqual({
      title: 'a.xyz could not be used',
      text: 'Line 7: the second number is missing.',
      advice: '',
    });
    expect(describeLoadingError({ ...error, kind: 'too_large' }).advice).toContain('Thin the points out');
  });
});

describe('a model from points', () => {
  it('tells how many points it read and fitted, and how well', () => {
    expect(factsOf(info).map(({ label, value, unit }) => `${label} ${value}${unit}`)).toEqual([
      'Normals from the mesh',
      'Condition number 1.1·10⁷',
      'Mean distance 0.22%',
      '95 % are nearer than 0.64%',
      'Largest distance 1.3%',
    ]);
    expect(plainOf(info)).toBe(
      'A smooth surface through 5,205 points, on average 0.22 % of their size away from them.',
    );
    expect(fittedOf(info)).toContain('f is fitted to 5,205 points, with 400 as centres');
    expect(fittedOf({ ...info, points: 200, centres: 200 })).toContain('f interpolates all 200 points');
  });

  it("has a story and a credit, as a surface has; a file has its name, and a formula of one's own neither", () => {
    const description = /** @type {any} */ ({
      models: [{ id: 'bunny', name: 'Bunny', story: 'It hops.', credit: 'Stanford', points: 200 }],
      surfaces: [{ id: 'sphere', name: 'Sphere', story: 'Round.', source: 'Archimedes', degree: 2, genus: 0 }],
    });
    expect(storyOf(description, 'bunny', null)).toEqual({
      name: 'Bunny',
      facts: '200 points',
      text: 'It hops.',
      credit: 'Stanford',
    });
    expect(storyOf(description, FILE_SURFACE, info)).toMatchObject({
      name: 'dragon.ply',
      facts: '5,205 points',
      text: 'The surface that is fitted to the points of this file.',
    });
    expect(storyOf(description, 'sphere', null)).toMatchObject({ facts: 'Degree 2 · genus 0', credit: 'Archimedes' });
    expect(storyOf(description, null, null).name).toBe('Your own formula');
  });
});
