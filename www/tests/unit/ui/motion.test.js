import { signal } from '@preact/signals-core';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { CROSSING_S, createMotion, placeAt, TURN_S, valueAt } from '../../../src/ui/motion.js';

const RANGE = { name: 'a', min: 1, max: 3, step: 0.1 };

/** An engine with a parameter `a`, and the stage under the picture. */
function page() {
  const engine = {
    state: signal({ parameters: /** @type {Record<string, number>} */ ({}) }),
    field: signal({ parameters: [{ name: 'a', value: 2 }] }),
    status: signal('rest'),
    /** @type {[number, boolean][]} */
    set: [],
    turned: 0,
    setParameter(/** @type {string} */ name, /** @type {number} */ value, { live = false } = {}) {
      engine.set.push([value, live]);
      engine.state.value = { parameters: { [name]: value } };
    },
    orbit(/** @type {number} */ rad) {
      engine.turned += rad;
    },
  };
  const stage = new EventTarget();
  return { engine, stage, motion: createMotion(/** @type {any} */ (engine), /** @type {any} */ (stage)) };
}

describe('the place in a range', () => {
  test('goes to the end and back, or again from the beginning', () => {
    expect([0, 0.25, 1, 1.25, 1.75, 2.5].map((t) => placeAt(t, 'bounce'))).toEqual([0, 0.25, 1, 0.75, 0.25, 0.5]);
    expect([0, 0.25, 1.25, 2.5].map((t) => placeAt(t, 'loop'))).toEqual([0, 0.25, 0.25, 0.5]);
  });

  test('gives a value on the grid of the slider', () => {
    expect(valueAt(RANGE, 0)).toBe(1);
    expect(valueAt(RANGE, 0.333)).toBe(1.7);
    expect(valueAt(RANGE, 1)).toBe(3);
  });
});

describe('motion', () => {
  /** Lets so many seconds pass, in frames of 50 ms. */
  let pass = (/** @type {number} */ _seconds) => {};
  beforeEach(() => {
    let now = 0;
    /** @type {((nowMs: number) => void) | null} */
    let frame = null;
    vi.stubGlobal('performance', { now: () => now });
    vi.stubGlobal('requestAnimationFrame', (/** @type {(nowMs: number) => void} */ act) => {
      frame = act;
      return 1;
    });
    pass = (seconds) => {
      for (let i = 0; i < Math.round(seconds * 20) && frame; i += 1) {
        now += 50;
        const act = frame;
        frame = null;
        act(now);
      }
    };
  });
  afterEach(() => vi.unstubAllGlobals());

  test('of a parameter begins where it is, passes both ends, and ends with a run of full quality', () => {
    const { engine, motion } = page();
    motion.toggle(RANGE);
    expect(motion.playing.value).toBe('a');
    pass(0.5);
    expect(engine.set[0]).toEqual([2.1, true]);
    pass(2 * CROSSING_S);
    const values = engine.set.map(([value]) => value);
    expect([Math.min(...values), Math.max(...values)]).toEqual([1, 3]);
    expect(engine.set.every(([, live]) => live)).toBe(true);
    motion.toggle(RANGE);
    expect(motion.playing.value).toBe(null);
    expect(engine.set.at(-1)).toEqual([values.at(-1), false]);
    const { length } = engine.set;
    pass(1);
    expect(engine.set).toHaveLength(length);
  });

  test('waits for a run that takes longer than a frame', () => {
    const { engine, motion } = page();
    engine.status.value = 'sampling';
    motion.toggle(RANGE);
    pass(1);
    expect(engine.set).toEqual([]);
    engine.status.value = 'rest';
    pass(0.05);
    expect(engine.set).toHaveLength(1);
  });

  test('gives way to the user and to another formula', () => {
    const { engine, motion } = page();
    motion.toggle(RANGE);
    pass(0.5);
    engine.setParameter('a', 1.234);
    pass(0.1);
    expect(motion.playing.value).toBe(null);
    expect(engine.state.value.parameters.a).toBe(1.234);
    motion.toggle(RANGE);
    pass(0.5);
    engine.field.value = { parameters: [] };
    pass(0.1);
    expect(motion.playing.value).toBe(null);
  });

  test('on the turntable goes once round in its time, until the picture is pressed or all is stopped', () => {
    const { engine, stage, motion } = page();
    expect(motion.stop()).toBe(false);
    motion.toggleTurning();
    pass(TURN_S);
    expect(engine.turned).toBeCloseTo(2 * Math.PI, 5);
    stage.dispatchEvent(new Event('pointerdown'));
    expect(motion.turning.value).toBe(false);
    motion.speed.value = 2;
    motion.toggleTurning();
    pass(0.05);
    const { turned } = engine;
    pass(TURN_S / 4);
    expect(engine.turned - turned).toBeCloseTo(Math.PI, 5);
    expect(motion.stop()).toBe(true);
    expect(motion.turning.value).toBe(false);
  });
});
