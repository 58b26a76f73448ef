import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { viewOf } from '../../../src/engine/view/camera.js';
import { MOST_PAINTED, Painter } from '../../../src/engine/view/painter.js';

const [WIDTH, HEIGHT] = [60, 40];

beforeEach(() => {
  vi.stubGlobal(
    'ImageData',
    class {
      /** @param {number} width @param {number} height */
      constructor(width, height) {
        Object.assign(this, { width, height, data: new Uint8ClampedArray(4 * width * height) });
      }
    },
  );
});
afterEach(() => vi.unstubAllGlobals());

test('many discs are painted in parts, of which the canvas shows the whole alone', async () => {
  const shown = /** @type {Uint8Array[]} */ ([]);
  const putImageData = (/** @type {ImageData} */ { data }) => shown.push(Uint8Array.from(data));
  const painter = await Painter.create(/** @type {any} */ ({ getContext: () => ({ putImageData }) }));
  const n = 2 * MOST_PAINTED + 1;
  const positions = Float32Array.from({ length: 3 * n }, (_, i) => Math.sin(12.9898 * i));
  painter.write(0, positions, positions, new Float32Array(n).fill(0.01), new Uint32Array(n), new Uint32Array(n), -1);
  painter.resize(WIDTH, HEIGHT);
  const camera = { target: [0, 0, 0], distance: 5, yaw: 0.5, pitch: 0.5, fit: false };
  const ball = { centre: [0, 0, 0], radius: 2 };
  painter.set_view(viewOf(/** @type {any} */ (camera), WIDTH, HEIGHT, /** @type {any} */ (ball), undefined).packed);
  painter.set_count(n, 0);
  expect([0, 1, 2].map(() => [painter.draw(0), shown.length])).toEqual([
    ['part', 0],
    ['part', 0],
    ['drawn', 1],
  ]);
  expect(shown[0]).toEqual(await painter.read_pixels(WIDTH, HEIGHT, false));
  // A picture that is read back in between begins the one on the screen anew.
  painter.draw(0);
  await painter.read_pixels(WIDTH, HEIGHT, false);
  expect([0, 1, 2].map(() => painter.draw(0))).toEqual(['part', 'part', 'drawn']);
  expect(shown[1]).toEqual(shown[0]);
  painter.set_count(10, 0);
  expect(painter.draw(0)).toBe('drawn');
});
