import { describe, expect, it } from 'vitest';
import { differences, History, MOST_ENTRIES } from '../../../src/ui/history.js';

/** @param {object} [change] @returns {any} */
const shape = (change) => ({
  surface: 'sphere',
  formula: 'x',
  parameters: {},
  declared: [],
  bounds: null,
  plane: null,
  settings: {},
  camera: { target: [0, 0, 0], distance: 5, yaw: 0.6, pitch: 0.4, fit: true },
  ...change,
});

describe('the history', () => {
  it('goes back and forth, and forgets what was undone when something else is done', () => {
    const history = new History();
    history.record(shape(), 0);
    expect(history.canUndo).toBe(false);
    history.record(shape({ surface: 'torus', formula: 'y' }), 1);
    history.record(shape({ surface: 'heart', formula: 'z' }), 2);
    expect(history.move(-1)?.surface).toBe('torus');
    expect(history.move(-1)?.surface).toBe('sphere');
    expect(history.move(-1)).toBeNull();
    expect(history.move(1)?.surface).toBe('torus');
    history.record(shape({ surface: 'cube', formula: 'w' }), 3);
    expect(history.canRedo).toBe(false);
    expect(history.move(-1)?.surface).toBe('torus');
  });

  it('takes a drag for one change, and a pause for its end', () => {
    const history = new History();
    history.record(shape(), 0);
    for (let i = 1; i <= 50; i += 1) history.record(shape({ parameters: { a: i } }), i * 16);
    expect(history.entries.length).toBe(2);
    history.record(shape({ parameters: { a: 60 } }), 5000);
    expect(history.entries.length).toBe(3);
    history.record(shape({ parameters: { a: 60, b: 1 } }), 5001);
    expect(history.entries.length).toBe(4);
    expect(history.move(-1)?.parameters).toEqual({ a: 60 });
  });

  it('takes every marked edge for one change, however soon the next follows', () => {
    const history = new History();
    /** @type {import('../../../src/engine/types.js').Line} */
    const line = [
      [0, 0, 0],
      [1, 0, 0],
    ];
    for (const [k, lines] of [[], [line], [line, line]].entries()) history.record(shape({ lines }), k);
    expect(history.move(-1)?.lines).toEqual([line]);
    expect(history.move(-1)?.lines).toEqual([]);
  });

  it('takes every stroke of the brush for one change, however soon the next follows', () => {
    const history = new History();
    for (const [k, brush] of ['', '0 0 0 1 2', '0 0 0 1 2;1 0 0 1 2'].entries())
      history.record(shape({ settings: brush ? { brush } : {} }), k);
    expect(history.move(-1)?.settings).toEqual({ brush: '0 0 0 1 2' });
    expect(history.move(-1)?.settings).toEqual({});
  });

  it('never comes back to half a formula', () => {
    const history = new History();
    history.record(shape({ formula: 'x' }), 0);
    history.record(shape({ formula: 'x+' }), 1000);
    history.record(shape({ formula: 'x+y' }), 9000, { faulty: true });
    expect(history.entries.map(({ formula }) => formula)).toEqual(['x', 'x+y']);
  });

  it('takes a formula that is typed in the place of a model for one change, whatever surface its letters bring', () => {
    const history = new History();
    const typed = (/** @type {string} */ surface, /** @type {string} */ formula, /** @type {number} */ nowMs) =>
      history.record(shape({ surface, formula }), nowMs, { isWritten: true, faulty: formula !== 'max(model, z)' });
    history.record(shape({ surface: 'bunny', formula: 'model' }), 0);
    for (const [k, text] of ['m', 'max(', 'max(mod'].entries()) typed('sphere', text, 1000 + 100 * k);
    typed('bunny', 'max(model, z)', 1400);
    expect(history.entries.map(({ formula }) => formula)).toEqual(['model', 'max(model, z)']);
    history.record(shape({ surface: 'torus', formula: 'y' }), 1500);
    expect(history.entries.length).toBe(3);
  });

  it('takes a look around for one change, to fit the surface again for another, and what the camera does by itself for none', () => {
    const history = new History();
    const { camera } = shape();
    const seen = (/** @type {object} */ change) => shape({ camera: { ...camera, ...change } });
    history.record(shape(), 0);
    // The camera follows a surface that has grown.
    history.record(seen({ distance: 7 }), 9000);
    expect(history.canUndo).toBe(false);
    for (let i = 1; i <= 5; i += 1) history.record(seen({ distance: 7, yaw: i }), 10_000 * i);
    expect(history.entries.length).toBe(2);
    history.record(seen({ distance: 2, yaw: 5, fit: false }), 60_000);
    history.record(seen({ distance: 7, yaw: 5 }), 60_001);
    expect(history.entries.length).toBe(4);
    expect(history.move(-1)?.camera.distance).toBe(2);
    expect(history.move(-1)?.camera).toMatchObject({ distance: 7, yaw: 5 });
    expect(history.move(-1)?.camera).toMatchObject({ distance: 7, yaw: 0.6 });
    expect(history.canUndo).toBe(false);
  });

  it('does not record what it has itself restored', () => {
    const history = new History();
    history.record(shape(), 0);
    history.record(shape({ formula: 'y' }), 1);
    const back = history.move(-1);
    history.record({ .../** @type {any} */ (back) }, 2);
    expect(history.canRedo).toBe(true);
  });

  it('is bounded: five hundred steps back end at the hundredth', () => {
    const history = new History();
    for (let i = 0; i < 500; i += 1) history.record(shape({ surface: `s${i}`, formula: `${i}` }), i);
    expect(history.entries.length).toBe(MOST_ENTRIES + 1);
    let last = null;
    for (let i = 0; i < 500; i += 1) last = history.move(-1) ?? last;
    expect(last?.surface).toBe(`s${499 - MOST_ENTRIES}`);
    expect(history.canUndo).toBe(false);
  });

  it('knows the one thing in which two states differ', () => {
    expect(differences(shape(), shape({ formula: 'y' }))).toEqual(['formula']);
    expect(differences(shape(), shape({ settings: { count: 3 } }))).toEqual(['settings.count']);
    expect(differences(shape({ plane: { normal: [0, 0, 1], offset: 0 } }), shape())).toEqual(['plane']);
    expect(differences(shape({ parameters: { a: 1 } }), shape())).toEqual(['parameters.a']);
    expect(differences(shape(), shape({ formula: 'y', parameters: { a: 1 } }))).toEqual(['formula', 'parameters.a']);
    expect(differences(shape(), shape())).toEqual([]);
  });
});
