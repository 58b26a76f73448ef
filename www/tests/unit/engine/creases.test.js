import { describe, expect, it } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { CreaseUpload, endsOf, radiiOf } from '../../../src/engine/view/creases.js';
import { PALETTES } from '../../../src/engine/view/palettes.js';

/** Six rows of four particles: two on a crease, with a row on either side, and two beside it. */
function creased() {
  const columns = new Columns();
  const count = 6;
  columns.write({
    first: 0,
    total: count,
    positions: Float32Array.from({ length: 3 * count }, (_, i) => i),
    normals: new Float32Array(3 * count),
    radii: Float32Array.of(1, 1, 2, 2, 3, 3),
    levels: new Uint32Array(count),
    parents: new Uint32Array(count),
    creases: { twins: Uint32Array.of(0, 0, 2, 2), segments: Uint32Array.of(0, 2), seams: new Uint32Array(0) },
    progress: /** @type {any} */ ({ particles: 4 }),
  });
  return columns;
}

describe('creases', () => {
  it('have rows of which the first stands for the particle', () => {
    const columns = creased();
    expect(columns.particles).toBe(4);
    expect([0, 1, 2, 3, 4, 5].filter((i) => columns.isFurther(i))).toEqual([1, 3]);
    expect([0, 1, 2, 3, 4, 5].map((i) => columns.firstRow(i))).toEqual([0, 0, 2, 2, 4, 5]);
    columns.clear();
    expect([columns.particles, columns.twins.length, columns.segments.length]).toEqual([0, 0, 0]);
  });

  it('have particles that are told from the tip of a cone, which has rows but no crease', () => {
    const columns = creased();
    expect([0, 2, 4].map((i) => columns.curveAt(i))).toEqual(['crease', 'crease', null]);
    columns.segments = new Uint32Array(0);
    expect([0, 2, 4].map((i) => columns.curveAt(i))).toEqual([null, null, null]);
  });

  it('are told from smooth joins, whose particles are discs', () => {
    const columns = creased();
    // A crease of one particle more, which a smooth join prolongs.
    columns.twins = Uint32Array.of(0, 0, 2, 2, 4, 4);
    columns.seams = Uint32Array.of(2, 4);
    expect([0, 2, 4].map((i) => columns.curveAt(i))).toEqual(['crease', 'crease', 'smooth join']);
    expect(columns.curves).toEqual(['creases', 'smooth joins']);
    expect([...radiiOf(columns, 0, 6)]).toEqual([-1, 0, -2, 0, 3, 0]);
  });

  it('carry dots: negative radii in the first rows, none in the others', () => {
    const columns = creased();
    expect([...radiiOf(columns, 0, 6)]).toEqual([-1, 0, -2, 0, 3, 3]);
    expect([...radiiOf(columns, 3, 5)]).toEqual([0, 3]);
    expect([...radiiOf(columns, 4, 6)]).toEqual([3, 3]);
    expect([...columns.radii.subarray(0, 6)]).toEqual([1, 1, 2, 2, 3, 3]);
  });

  it('are lines from particle to particle', () => {
    expect([...endsOf(creased())]).toEqual([0, 1, 2, 1, 6, 7, 8, 2]);
  });

  it('are uploaded when they, the theme or the choice change, and not else', () => {
    const columns = creased();
    const upload = new CreaseUpload(columns);
    /** @type {[number, number | undefined][]} */
    const written = [];
    const renderer = /** @type {any} */ ({
      write_lines: (/** @type {Float32Array} */ ends, /** @type {Uint32Array} */ colours) =>
        written.push([ends.length, colours[0]]),
    });
    const look = (/** @type {boolean} */ creases, /** @type {'light' | 'dark'} */ theme) =>
      upload.write(renderer, /** @type {any} */ ({ creases, theme }));
    look(true, 'light');
    look(true, 'light');
    look(true, 'dark');
    look(false, 'dark');
    look(false, 'light');
    look(true, 'light');
    upload.restart();
    look(true, 'light');
    columns.clear();
    look(true, 'light');
    look(true, 'dark');
    const { light, dark } = PALETTES;
    expect(written).toEqual([
      [8, light.ink],
      [8, dark.ink],
      [0, undefined],
      [8, light.ink],
      [8, light.ink],
      [0, undefined],
    ]);
  });
});
