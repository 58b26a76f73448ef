import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { FrameLoop } from '../../src/engine/view/frames.js';

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
