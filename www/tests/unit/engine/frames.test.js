import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { FrameLoop } from '../../../src/engine/view/frames.js';

/** Frames that the browser was asked for. @type {(() => void)[]} */
let frames = [];
const page = { hidden: false, addEventListener: vi.fn(), removeEventListener: vi.fn() };

beforeEach(() => {
  vi.useFakeTimers();
  frames = [];
  page.hidden = false;
  vi.stubGlobal('document', page);
  vi.stubGlobal('requestAnimationFrame', (/** @type {() => void} */ frame) => frames.push(frame));
  vi.stubGlobal('cancelAnimationFrame', () => {});
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('a frame', () => {
  test('is asked for once, however often it is wanted', () => {
    const loop = new FrameLoop(() => 'drawn');
    loop.ask();
    loop.ask();
    expect(frames).toHaveLength(1);
    frames[0]();
    expect(loop.drawn).toBe(1);
    expect(loop.asked).toBe(0);
  });

  test('of a hidden page is not asked for', () => {
    page.hidden = true;
    new FrameLoop(() => 'drawn').ask();
    expect(frames).toHaveLength(0);
  });

  test('of a picture out of sight is not asked for, one that was is withdrawn, and who waits for it is let go', () => {
    const cancel = vi.fn();
    vi.stubGlobal('cancelAnimationFrame', cancel);
    const loop = new FrameLoop(() => 'drawn');
    const drawn = vi.fn();
    loop.ask();
    loop.afterNext(drawn);
    loop.see(false);
    expect(cancel).toHaveBeenCalledWith(1);
    expect(drawn).toHaveBeenCalledTimes(1);
    expect(loop.isHidden).toBe(true);
    loop.ask();
    expect(frames).toHaveLength(1);
    loop.see(true);
    expect(frames).toHaveLength(2);
  });

  test('after an hour asleep is one short step on, and no burst of frames', () => {
    const steps = /** @type {number[]} */ ([]);
    const loop = new FrameLoop((_now, step) => {
      steps.push(step);
      return 'drawn';
    });
    const [, shown] = page.addEventListener.mock.lastCall ?? [];
    loop.ask();
    frames[0]();
    page.hidden = true;
    shown();
    vi.advanceTimersByTime(3_600_000);
    page.hidden = false;
    shown();
    shown();
    expect(frames).toHaveLength(2);
    frames[1]();
    expect(steps[1]).toBeGreaterThan(0);
    expect(steps[1]).toBeLessThanOrEqual(0.05);
  });

  test('lets go who waits for it, also where there was nothing to draw with', () => {
    const loop = new FrameLoop(() => 'none');
    const seen = vi.fn();
    loop.afterNext(seen);
    loop.ask();
    expect(seen).not.toHaveBeenCalled();
    frames[0]();
    expect(seen).toHaveBeenCalledOnce();
    expect(loop.drawn).toBe(0);
  });

  test('that the screen did not take is drawn again, and not for ever', () => {
    const loop = new FrameLoop(() => 'skipped');
    loop.ask();
    for (let k = 0; k < 100 && k < frames.length; k += 1) {
      frames[k]();
      vi.advanceTimersByTime(1000);
    }
    expect(frames).toHaveLength(21);
  });
});

describe('a frame that is drawn in parts', () => {
  test('goes on by itself, counts once, and is waited for as a whole', () => {
    /** @type {import('../../../src/engine/view/types.js').FrameResult[]} */
    const results = ['part', 'part', 'drawn'];
    const loop = new FrameLoop(() => results.shift() ?? 'none');
    const drawn = vi.fn();
    loop.afterNext(drawn);
    loop.ask();
    for (let k = 0; k < 3; k += 1) {
      expect(drawn).not.toHaveBeenCalled();
      frames[k]();
    }
    expect(drawn).toHaveBeenCalledOnce();
    expect(loop.drawn).toBe(1);
    expect(frames).toHaveLength(3);
  });

  test('is followed by another if anything has changed meanwhile', () => {
    /** @type {import('../../../src/engine/view/types.js').FrameResult[]} */
    const results = ['part', 'drawn', 'drawn'];
    const loop = new FrameLoop(() => results.shift() ?? 'none');
    loop.ask();
    frames[0]();
    loop.ask();
    expect(frames).toHaveLength(2);
    frames[1]();
    expect(frames).toHaveLength(3);
    frames[2]();
    expect(frames).toHaveLength(3);
  });
});
