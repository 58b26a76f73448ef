import { describe, expect, it } from 'vitest';
import { coarsen, trim } from '../../../src/ui/report/bins.js';
import { listOf, placeOf } from '../../../src/ui/report/places.js';
import { PLAIN } from '../../../src/ui/report/plain.js';
import {
  compare,
  figuresOf,
  groupRows,
  headingsOf,
  isTold,
  valueAt,
  writeFigure,
  writeRange,
} from '../../../src/ui/report/rows.js';
import { wantsSlider } from '../../../src/ui/scale.js';
import { sentencesOf } from '../../../src/ui/segments.js';
import { captionOf, loadingOf } from '../../../src/ui/view/caption.js';

/** @import { ReportRow } from '../../../src/engine/types.js' */

/**
 * @param {Partial<ReportRow>} [change]
 * @returns {ReportRow}
 */
const row = (change) => ({
  key: 'quality.six_neighbours',
  to: null,
  unless: null,
  label: 'Valence six',
  group: 'Order',
  unit: '%',
  digits: 1,
  ideal: '100',
  better: 'higher',
  help: '',
  places: null,
  ...change,
});

describe('the places of a figure', () => {
  const columns = /** @type {any} */ ({
    count: 3,
    positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 2, 0),
    normals: Float32Array.of(0, 0, 1, 1, 0, 0, 0, 1, 0),
    radii: Float32Array.of(0.5, 0.25, 0.5),
  });
  const report = /** @type {any} */ ({
    places: {
      pairs: [
        { particles: [1, 2], ratio: 0.5 },
        { particles: [0, 2], ratio: 0.7 },
      ],
      holes: [{ position: [0, 1.75, 0], radius: 0.75, ratio: 1.5 }],
    },
  });

  it('are two particles, or a hole seen from outside', () => {
    expect(placeOf(listOf(report, 'places.pairs'), 0, columns)).toEqual({
      places: [
        [1, 0, 0],
        [0, 2, 0],
      ],
      radius: 0.5,
      normal: [1, 0, 0],
      text: '0.500 · 1 of 2',
    });
    expect(placeOf(listOf(report, 'places.holes'), 0, columns)).toEqual({
      places: [[0, 1.75, 0]],
      radius: 0.75,
      normal: [0, 1, 0],
      text: '1.50',
    });
  });

  it('are none without a report, and for other figures', () => {
    expect(listOf(null, 'places.pairs')).toEqual([]);
    expect(listOf(report, null)).toEqual([]);
    expect(listOf(report, 'places.none')).toEqual([]);
  });
});

describe('the report', () => {
  it('finds figures by their path, and the same before relaxation', () => {
    const report = /** @type {any} */ ({
      count: 5,
      energy: [0.2, 0.1],
      quality: { six_neighbours: 0.97 },
      quality_before: { six_neighbours: 0.93 },
    });
    expect(valueAt(report, 'quality.six_neighbours')).toBe(0.97);
    expect(valueAt(report, 'quality.none.deeper')).toBeUndefined();
    expect(valueAt({ quality: { bond_order: Number.NaN, rho: Infinity } }, 'quality.bond_order')).toBeNull();
    expect(valueAt({ quality: { bond_order: Number.NaN, rho: Infinity } }, 'quality.rho')).toBeNull();
    expect(figuresOf(report, 'quality.six_neighbours')).toEqual({ now: 0.97, before: 0.93 });
    expect(figuresOf({ ...report, quality_before: null }, 'quality.six_neighbours').before).toBeUndefined();
    expect(figuresOf(report, 'count')).toEqual({ now: 5, before: undefined });
  });

  it('has one column of figures of a run without relaxation', () => {
    for (const energy of [null, [0.2]]) {
      const report = /** @type {any} */ ({ energy, quality: { six_neighbours: 0.93 }, quality_before: null });
      expect(figuresOf(report, 'quality.six_neighbours')).toEqual({ now: 0.93, before: undefined });
      expect(isTold(report, row())).toBe(true);
    }
  });

  it('heads the figures of a refined run by what it is', () => {
    const headings = (/** @type {number | null} */ levels, /** @type {number[] | null} */ energy = null) =>
      headingsOf(/** @type {any} */ ({ refined_levels: levels, energy }));
    expect(headings(3)).toEqual(['', 'Refined']);
    expect(headings(0)).toEqual(['', 'Refined']);
    expect(headings(3, [0.2, 0.1])).toEqual(['Refined', 'Relaxed']);
    expect(headings(null)).toEqual(['', 'Front']);
    expect(headings(null, [0.2, 0.1])).toEqual(['Front', 'Relaxed']);
    expect(headingsOf(null)).toEqual(['Front', 'Relaxed']);
  });

  it('begins with four figures in plain words', () => {
    const plain = (/** @type {object} */ report) => PLAIN.map(({ write }) => write(/** @type {any} */ (report)));
    const quality = { spacing_variation: 0.0732, error_max: 5.3e-5 };
    expect(plain({ count: 4301, quality, search: 'proven', sampled: { missing: 0 } })).toEqual([
      '4,301',
      '±\u202f7.3\u202f%',
      '0.0053\u202f%',
      'proven',
    ]);
    const poor = { spacing_variation: 0.3, size_variation: 0.081, error_max: 1e-8 };
    expect(plain({ count: 1, quality: poor, search: 'searched', sampled: { missing: 2 } })).toEqual([
      '1',
      '±\u202f8.1\u202f%',
      'below 0.001\u202f%',
      'all but 2',
    ]);
    expect(plain({ count: 3, quality: null, search: null })).toEqual(['3', '–', '–', '–']);
  });

  it('shows the first sentence of a warning, and folds the others', () => {
    expect(sentencesOf('Too small here: choose less. At (0.1, 2. 5) it is 0.5. Then more.')).toEqual({
      first: 'Too small here: choose less.',
      rest: 'At (0.1, 2. 5) it is 0.5. Then more.',
    });
    expect(sentencesOf('One alone.')).toEqual({ first: 'One alone.', rest: '' });
  });

  it('writes shares as per cent, whole numbers grouped, and words as they are', () => {
    expect(writeFigure(row(), 0.9671)).toBe('96.7');
    expect(writeFigure(row({ unit: '', digits: 0 }), 55748)).toBe('55,748');
    expect(writeFigure(row({ unit: 'r', digits: 3 }), 1.2)).toBe('1.200');
    expect(writeFigure(row({ unit: '', digits: 3 }), 967.7634)).toBe('967.76');
    expect(writeFigure(row({ unit: '', digits: 3 }), -123456.7)).toBe('−123,457');
    expect(writeFigure(row({ unit: '', digits: 6 }), 0.0000532)).toBe('5.3·10⁻⁵');
    expect(writeFigure(row({ unit: '', digits: 6 }), 0)).toBe('0');
    expect(writeFigure(row(), null)).toBe('–');
    expect(writeFigure(row(), 'complete')).toBe('complete');
    expect(writeFigure(row(), 'searched')).toBe('by search');
  });

  it('writes a range as its ends, or as one figure', () => {
    const radius = row({ key: 'radius_min', to: 'radius_max', unit: '', digits: 4 });
    expect(writeRange(radius, /** @type {any} */ ({ radius_min: 0.01234, radius_max: 0.1 }))).toBe(
      '0.0123\u202f–\u202f0.1',
    );
    expect(writeRange(radius, /** @type {any} */ ({ radius_min: 0.02, radius_max: 0.02 }))).toBe('0.02');
  });

  it('calls a figure better only when the change can be read', () => {
    expect(compare(row(), 0.93, 0.97)).toBe('better');
    expect(compare(row(), 0.93, 0.9301)).toBe('same');
    expect(compare(row({ better: 'lower' }), 0.93, 0.97)).toBe('worse');
    expect(compare(row({ better: null }), 0, 1)).toBe('same');
    expect(compare(row(), undefined, 1)).toBe('same');
  });

  it('leaves out what a run says nothing of', () => {
    const report = /** @type {any} */ ({
      undecided_cells: null,
      count: 0,
      energy: [0.2, 0.1],
      quality: { six_neighbours: null },
      quality_before: { six_neighbours: 0.9 },
    });
    expect(isTold(report, { key: 'count' })).toBe(true);
    expect(isTold(report, { key: 'undecided_cells' })).toBe(false);
    expect(isTold(report, { key: 'not_there' })).toBe(false);
    expect(isTold(report, { key: 'quality.six_neighbours' })).toBe(true);
    expect(isTold(null, { key: 'undecided_cells' })).toBe(true);
    expect(isTold(report, { key: 'count', unless: 'quality.six_neighbours' })).toBe(false);
    expect(isTold(report, { key: 'count', unless: 'undecided_cells' })).toBe(true);
  });

  it('groups rows in the order of their first member', () => {
    const groups = groupRows([row({ group: 'B' }), row({ group: 'A' }), row({ group: 'B', key: 'x' })]);
    expect([...groups].map(([name, rows]) => [name, rows.length])).toEqual([
      ['B', 2],
      ['A', 1],
    ]);
  });
});

describe('histogram bins', () => {
  it('keep every particle when they are made wider', () => {
    const bins = Array.from({ length: 50 }, (_, i) => (i > 4 && i < 40 ? i : 0));
    const rows = coarsen({ min: 1, max: 2, bins }, 12);
    expect(rows.length).toBeLessThanOrEqual(12);
    expect(rows.reduce((sum, { count }) => sum + count, 0)).toBe(bins.reduce((sum, count) => sum + count, 0));
    expect(rows[0].from).toBeCloseTo(1 + 5 / 50);
    expect(rows.at(-1)?.to).toBeCloseTo(1 + 40 / 50);
  });

  it('lose their empty ends, but not the ideal distance', () => {
    const bins = Array.from({ length: 120 }, (_, i) => (i >= 80 && i < 95 ? 1 : 0));
    const shown = trim({ min: 0, max: 1.2, bins }, 1);
    expect(shown.bins.reduce((sum, count) => sum + count, 0)).toBe(15);
    expect(shown.min).toBeCloseTo(0.77);
    expect(shown.max).toBeGreaterThan(1);
    expect(shown.max - shown.min).toBeCloseTo(shown.bins.length / 100);
    expect(trim({ min: 0, max: 1, bins: [0, 0] }, 1)).toEqual({ min: 0, max: 1, bins: [0, 0] });
  });

  it('are none where nothing was counted', () => {
    expect(coarsen({ min: 0, max: 1, bins: [0, 0] }, 12)).toEqual([]);
    expect(coarsen({ min: 0, max: 1, bins: [] }, 12)).toEqual([]);
  });
});

describe('the caption', () => {
  const progress = /** @type {any} */ ({
    phase: 'generation',
    level: 12,
    particles: 1463,
    refine_level: 2,
    refine_levels: 4,
    relax_step: 4,
    relax_steps: 10,
    stop_reason: null,
  });
  const facts = { partial: false, empty: false, busy: true, seconds: null, steps: 0 };

  it('names the phase and the count while a run is under way', () => {
    expect(captionOf(progress, facts)).toBe('Level 12 · 1,463 particles');
    expect(captionOf({ ...progress, phase: 'refinement' }, facts)).toBe('Refining, level 2 of 4 · 1,463 particles');
    expect(captionOf({ ...progress, phase: 'relaxation' }, facts)).toBe('Relaxation 4 of 10 · 1,463 particles');
  });

  it('says of which relaxation steps the time is, if it is not that of the sampling', () => {
    const rest = { ...facts, busy: false, seconds: 0.05 };
    const done = { ...progress, phase: 'done', stop_reason: 'complete' };
    expect(captionOf(done, { ...rest, steps: 1 })).toBe('1,463 particles · 50\u202fms for the last step');
    expect(captionOf(done, { ...rest, steps: 5 })).toBe('1,463 particles · 50\u202fms for the last 5 steps');
  });

  it('tells how far a model on its way is', () => {
    expect(loadingOf({ id: 'bunny', name: 'Bunny', label: 'Solving', fraction: 0.416 })).toBe('Bunny · Solving · 42%');
  });

  it('says so when a run was stopped or met its limit', () => {
    const done = { ...progress, phase: 'done' };
    const stopped = (/** @type {object} */ place) =>
      captionOf(
        { ...done, relax_step: 0, refine_level: 0, stop_reason: 'cancelled', ...place },
        { ...facts, busy: false, partial: true },
      );
    expect(stopped({})).toBe('Stopped at level 12 · 1,463 particles');
    expect(stopped({ relax_step: 4 })).toBe('Stopped after relaxation 4 of 10 · 1,463 particles');
    expect(stopped({ refine_level: 2 })).toBe('Stopped refining, level 2 of 4 · 1,463 particles');
    expect(stopped({ level: 0 })).toBe('Stopped · 1,463 particles');
    expect(captionOf({ ...done, particles: 0 }, { ...facts, busy: false })).toBe('');
    expect(captionOf({ ...done, stop_reason: 'cap' }, { ...facts, busy: false, partial: true })).toBe(
      'Stopped at the limit · 1,463 particles',
    );
    expect(captionOf({ ...done, stop_reason: 'complete' }, { ...facts, busy: false, seconds: 0.05 })).toBe(
      '1,463 particles · 50\u202fms',
    );
    expect(captionOf({ ...done, particles: 0 }, { ...facts, busy: false, empty: true })).toBe('');
  });
});

describe('a setting', () => {
  const info = /** @type {any} */ ({ kind: 'integer', min: 0, max: 200, step: 1, scale: 'linear' });
  it('gets a slider where it can be aimed', () => {
    expect(wantsSlider(info)).toBe(true);
    expect(wantsSlider({ ...info, max: 4294967295 })).toBe(false);
    expect(wantsSlider({ ...info, max: 1e6, scale: 'log' })).toBe(true);
    expect(wantsSlider({ ...info, kind: 'choice' })).toBe(false);
  });
});
